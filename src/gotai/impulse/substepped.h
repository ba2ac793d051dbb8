/// @file
/// The fast contact solver: soft constraints in sub-steps, sixteen pairs at a time.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "gotai/core/stages.h"
#include "gotai/impulse/contact_schedule.h"
#include "gotai/impulse/method.h"
#include "gotai/impulse/soft_kernel.h"

namespace gotai::impulse {

/// Constraint-based impulses by projected Gauss-Seidel over sub-steps
/// [Macklin et al. 2019, "Small Steps in Physics Simulation"; Catto 2023, "Solver2D"].
///
/// Every sub-step warm starts, solves once with overlap recovery as a stiff damped spring, moves
/// the bodies, and relaxes twice without it, so that recovery adds no energy. Restitution comes
/// once, at the end of the step. Stacks, small islands of bodies on bodies, are swept many times:
/// there sweeps are cheap, and tall stacks need them. Overlap recovery drives slow modes, such as
/// the sway of a stack, in every sub-step; they grow where sweeps damp them less than that.
///
/// Reads: all contacts, or the reduced ones; contacts may exist before touching.
/// Guarantees: impulses push, friction stays in the cone, cost linear in contacts, the same bits
/// for any number of threads and instruction set. Does not: solve the complementarity problem to
/// round-off; report().residual says how far off it is.
class SubsteppedConstraint final : public ImpulseMethod {
 public:
  explicit SubsteppedConstraint(const model::Settings& settings);

  model::StepPlan plan(const model::BodyState& bodies, double dt) const override;
  void prepare(const model::BodyState& bodies, const model::ContactSet& contacts,
               const model::MaterialTable& materials, const model::StepPlan& plan,
               const model::ContactMemory& memory) override;
  void solve(const model::BodyState& bodies, const std::vector<double>& gap,
             model::Update& update) override;
  void relax(const model::BodyState& bodies, model::Update& update) override;
  void finish(const model::BodyState& bodies, model::Update& update,
              model::ContactMemory& memory) override;
  model::SolveReport report() const override { return report_; }

 private:
  /// Where a contact sits: row and lane.
  struct Slot {
    std::uint32_t row = 0;
    std::uint32_t lane = 0;
  };
  /// Pairs of a batch.
  struct Contents {
    std::uint32_t first_pair = 0;  ///< in the schedule's order
    std::uint32_t kind = 0;        ///< IslandKind
  };
  struct Range {
    std::uint32_t begin = 0;
    std::uint32_t end = 0;
  };

  void lay_out_batches();
  void fill_batch(std::size_t k, const model::BodyState& bodies,
                  const model::MaterialTable& materials, const model::ContactMemory& memory);
  void fill_rows(std::uint32_t p, std::size_t lane, std::uint32_t row_begin, double friction,
                 const Vec3& x_a, const model::ContactMemory& memory);
  /// Moves the friction of a pair that slides to where the resultants of its shares act.
  void slide(const model::ContactPair& pair, double friction, const Vec3& x_a);
  /// Where the entries of every pair are in the memory.
  void find_memories(const model::ContactMemory& memory);
  /// Resistance of a pair to rolling, in a lane of batch k.
  void fill_rolling(std::uint32_t p, std::size_t k, std::uint32_t lane,
                    const model::BodyState& bodies, const model::ContactMemory& memory);
  /// Arm of the largest torque against rolling [m].
  double rolling_arm(const model::BodyState& bodies, model::BodyIndex a, model::BodyIndex b) const;
  void remember(model::ContactMemory& memory);
  /// Moves the warm start of each pair towards the impulses of equal wrench that press evenly, by
  /// area: redundant contacts share the load, as under a uniform tiny compliance (erratum 23).
  /// Only of pairs that slide: there pressure decides the torque of friction. At rest it would
  /// disturb what the solver has found, and piles would creep.
  void share_loads();
  void share_load(const model::ContactPair& pair);
  /// Lets the friction of sliding shares follow the pressure on the shares instead of that on their
  /// contacts, which are beside their centres, and move load among each other as they are swept:
  /// each gets its fraction of all that presses the pair, of the same wrench and even by area. Once
  /// a step, after the first sub-step: what contacts remember lacks those that are not kept again.
  void press_shares();
  /// The same of one pair. @return false if nothing presses it
  bool press_shares(const model::ContactPair& pair, std::span<const model::SlidingShare> shares);
  /// Of the sub-step to come [N s].
  double normal_impulse(std::uint32_t contact) const {
    return rows_[slots_[contact].row].p_n.value[slots_[contact].lane];
  }
  /// Shifts a sliding pair's friction so that its centre is that of the pressure: the points that
  /// friction acts at stand for areas, and under uneven pressure they would turn the body.
  void centre_friction(const model::ContactPair& pair);

  SoftProblem problem();
  /// Adds passes wave after wave: batches of a wave share no dynamic body, so the bits do not
  /// depend on the threads.
  void add_waves(std::size_t kind, SoftPass pass);
  /// Adds a pass that needs nothing of other batches.
  void add_at_once(SoftPass pass);
  void run_passes();
  void read_velocities(const model::BodyState& bodies);
  void write_changes(const model::BodyState& bodies, model::Update& update) const;

  model::Settings settings_;
  model::StepPlan plan_;
  int substep_ = 0;
  model::SolveReport report_;
  const model::ContactSet* contacts_ = nullptr;
  ContactScheduler scheduler_;
  const ContactSchedule* schedule_ = nullptr;
  std::vector<PairBatch> batches_;
  std::vector<Contents> in_batch_;                      // per batch
  std::array<std::vector<Range>, kIslandKinds> waves_;  // of batches_, by IslandKind
  std::vector<Stage<SoftPass>> stages_;
  std::vector<RollingBatch> rolling_;  // per batch; empty if nothing resists rolling
  std::vector<ContactRow> rows_;
  std::vector<Slot> slots_;               // per contact
  std::vector<Slot> rolling_slots_;       // per pair: batch and lane
  std::vector<std::uint8_t> is_sliding_;  // per pair
  std::vector<Range> memory_of_;          // per pair, into the memory
  std::vector<std::uint32_t> entry_of_;   // per pair + 1: first entry of the next step's memory
  std::vector<SoftBody> velocity_;        // working copy; entry 0 is padding, body i is entry i + 1
  std::vector<SoftBody> before_;          // as read from the state
};

}  // namespace gotai::impulse
