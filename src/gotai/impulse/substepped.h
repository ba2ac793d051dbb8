/// @file
/// The fast contact solver: soft constraints in sub-steps, eight pairs at a time.
#pragma once

#include <vector>

#include "gotai/impulse/contact_schedule.h"
#include "gotai/impulse/method.h"
#include "gotai/impulse/soft_kernel.h"

namespace gotai::impulse {

/// Constraint-based impulses by projected Gauss-Seidel over sub-steps
/// [Macklin et al. 2019, "Small Steps in Physics Simulation"; Catto 2023, "Solver2D"].
///
/// Every sub-step warm starts, solves once with overlap recovery as a stiff damped spring, moves
/// the bodies, and relaxes twice without it, so that recovery adds no energy. Restitution comes
/// once, at the end of the step.
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
  /// Where contact i of the solve sits: row and lane.
  struct Slot {
    std::uint32_t contact = 0;  ///< index into ContactSet
    std::uint32_t row = 0;
    std::uint32_t lane = 0;
  };

  void lay_out_batches(const model::BodyState& bodies, const model::MaterialTable& materials);
  void fill_rows(const model::BodyState& bodies);
  void load_warm_start(const model::ContactMemory& memory);
  /// Moves the warm start of each pair towards the impulses of equal wrench that press evenly, by
  /// area: redundant contacts share the load, as under a uniform tiny compliance (erratum 23).
  /// Only of pairs that slide: there pressure decides the torque of friction. At rest it would
  /// disturb what the solver has found, and piles would creep.
  void share_loads(const model::BodyState& bodies);
  void share_load(const model::ContactPair& pair);
  /// Shifts a sliding pair's friction so that its centre is that of the pressure: the points that
  /// friction acts at stand for areas, and under uneven pressure they would turn the body.
  void centre_friction(const model::ContactPair& pair);
  /// Calls kernel(first batch, count): wave after wave, the batches of one on any thread. They
  /// share no dynamic body, so the bits do not depend on the threads.
  template <typename Kernel>
  void for_waves(const Kernel& kernel);
  void read_velocities(const model::BodyState& bodies);
  void write_changes(const model::BodyState& bodies, model::Update& update) const;

  model::Settings settings_;
  model::StepPlan plan_;
  model::SolveReport report_;
  const model::ContactSet* contacts_ = nullptr;
  ContactScheduler scheduler_;
  std::vector<std::uint32_t> counts_;  // contacts per pair
  std::vector<PairBatch> batches_;     // wave by wave
  std::vector<std::size_t> wave_end_;  // into batches_
  std::vector<ContactRow> rows_;
  std::vector<Slot> slots_;         // in contact order
  std::vector<SoftBody> velocity_;  // working copy; entry 0 is padding, body i is entry i + 1
  std::vector<SoftBody> before_;    // as read from the state
};

}  // namespace gotai::impulse
