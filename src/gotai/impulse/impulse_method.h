/// @file
/// The impulse-based method: every contact on its own [Makino 2007, sections 2.2, 2.3; eq. 2.3].
#pragma once

#include <vector>

#include "gotai/impulse/assembly.h"
#include "gotai/impulse/method.h"
#include "gotai/impulse/patch_friction.h"

namespace gotai::impulse {

/// p_i = -(v*_i + e min(v_i, 0)) / (1/m_A + 1/m_B + n . [...]) for every contact as if it were
/// alone (2.3 in the reading of errata 3, 19), all superposed, or divided by the number of contacts
/// of the pair that fire.
///
/// Reads every contact that touches and approaches.
/// Guarantees: exact for one contact; momentum; a cost of one pass. Does not: superposed, n
/// redundant contacts push n times too hard and the energy explodes with the level; averaged, they
/// push too softly off centre (erratum 18: a flat cube of e = 0.5 still approaches), so that bodies
/// sink into each other. Both on record because chapters 2 and 4 compare them.
class SuperposedImpulses final : public ImpulseMethod {
 public:
  /// @param averaged  divide by the number of firing contacts of the pair
  SuperposedImpulses(const model::Settings& settings, bool averaged);

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
  model::Settings settings_;
  bool averaged_;
  const model::ContactSet* contacts_ = nullptr;  // of the step
  ContactTargets targets_;
  double dt_ = 0.0;
  std::vector<double> normal_impulse_;  // per contact [N s]
  WorkingVelocities velocities_;
  model::SolveReport report_;
};

}  // namespace gotai::impulse
