/// @file
/// The constraint method on apparent contact points [Makino 2007, chapter 5].
#pragma once

#include <vector>

#include "gotai/impulse/apparent_contact.h"
#include "gotai/impulse/assembly.h"
#include "gotai/impulse/cone_problem.h"
#include "gotai/impulse/islands.h"
#include "gotai/impulse/method.h"
#include "gotai/impulse/patch_friction.h"
#include "gotai/impulse/row_solver.h"

namespace gotai::impulse {

/// Collapses the contacts of every touching pair into one row, solves the small complementarity
/// problem over the pairs, and spreads the impulses back over the contacts, with friction (5.18,
/// 5.19). A row is the weighted sum of the contacts' rows, w'J / |sum w n|: its matrix w'A w /
/// |.|^2 is what the spread impulses really do, so that a pair never gains energy, whatever the
/// normals (erratum 39).
///
/// Reads every contact that touches; a pair without an approaching one is skipped. The faces of a
/// container count as pairs of their own.
/// Guarantees: one unknown per pair; no energy gain of a pair; friction on the original contacts
/// (a body spinning about the normal slows down, Fig. 5-5), never reversing the sliding; sticking.
/// Does not: stop every contact of a pair from approaching in the same step, nor balance moments
/// between pairs: stacked bodies tilt (erratum 42); bodies on the ground rock before they rest.
class ApparentMethod final : public ImpulseMethod {
 public:
  explicit ApparentMethod(const model::Settings& settings);

  model::StepPlan plan(const model::BodyState& bodies, double dt) const override;
  void prepare(const model::BodyState& bodies, const model::ContactSet& contacts,
               const model::MaterialTable& materials, const model::StepPlan& plan,
               const model::ContactMemory& memory) override;
  void solve(const model::BodyState& bodies, const std::vector<double>& gap,
             model::Update& update) override;
  void finish(const model::BodyState& bodies, model::Update& update,
              model::ContactMemory& memory) override;
  model::SolveReport report() const override { return report_; }

 private:
  void find_patches(const model::BodyState& bodies);
  /// Calls visit(index) for the island's patches that have an apparent contact, in order.
  template <typename Visit>
  void for_each_patch(const Island& island, const Visit& visit) const {
    for (const std::uint32_t pair : island.pairs) {
      for (std::uint32_t k = first_patch_[pair]; k < first_patch_[pair + 1]; ++k) {
        if (apparent_[k].exists) visit(k);
      }
    }
  }
  void find_weights(const model::BodyState& bodies, const std::vector<double>& gap);
  void assemble_pairs(const model::BodyState& bodies, const Island& island);
  void solve_pairs();

  model::Settings settings_;
  const model::ContactSet* contacts_ = nullptr;  // of the step
  ContactTargets targets_;
  double dt_ = 0.0;
  std::vector<Island> islands_;
  std::vector<model::ContactPair> patches_;  // pairs, those with containers cut into their faces
  std::vector<std::uint32_t>
      first_patch_;             // patches of pair k: [first_patch_[k], first_patch_[k+1])
  std::vector<double> v_star_;  // per contact, normal velocity with gravity [m/s]
  std::vector<double> bias_;    // per contact, row_bias() [m/s]
  std::vector<ApparentContact> apparent_;  // per patch
  std::vector<double> normal_impulse_;     // per contact [N s]
  ConeProblem problem_;                    // of one island: a row per apparent contact
  std::vector<Mat3> inertia_;              // per block
  std::vector<double> area_;               // per row
  RowSolver rows_;
  ConeSolution solution_;
  WorkingVelocities velocities_;
  model::SolveReport report_;
};

}  // namespace gotai::impulse
