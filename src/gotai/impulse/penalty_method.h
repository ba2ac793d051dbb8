/// @file
/// The penalty method: springs and dampers [Makino 2007, section 2.1; eqs. 2.1, 2.2].
#pragma once

#include "gotai/impulse/method.h"
#include "gotai/impulse/spring_forces.h"

namespace gotai::impulse {

/// f = sum_i (-k x_i - c v_i) n_i / n over the n contacts of a pair that overlap. The user gives
/// the restitution; c follows from it by (2.2), and k = m w^2 from the step and the allowed
/// penetration (impulse.penetration, of the smallest bounding radius):
///   w = max(pi / dt, sqrt(|g| / penetration)),
/// so that a collision lasts one step or less and a resting body sinks no deeper than allowed. The
/// damper may pull at the end of a contact when impulse.tension says so.
///
/// Reads every contact, also those that come to touch within the step.
/// Guarantees: the same stiffness at every level (k and c are divided by the number of contacts);
/// restitution as asked for central impacts, by (2.2) with tension, somewhat more of it for a small
/// e without (erratum 2); stability, by as many sub-steps as it takes (reported).
/// Does not: keep bodies apart (a fast one sinks v dt / pi deep), hold a shape's restitution off
/// centre, or come to rest at once.
class PenaltyMethod final : public ImpulseMethod {
 public:
  explicit PenaltyMethod(const model::Settings& settings);

  model::StepPlan plan(const model::BodyState& bodies, double dt) const override;
  void prepare(const model::BodyState& bodies, const model::ContactSet& contacts,
               const model::MaterialTable& materials, const model::StepPlan& plan,
               const model::ContactMemory& memory) override;
  void solve(const model::BodyState& bodies, const std::vector<double>& gap,
             model::Update& update) override;
  void finish(const model::BodyState& bodies, model::Update& update,
              model::ContactMemory& memory) override;
  model::SolveReport report() const override { return springs_.report(); }

 private:
  double frequency(const model::BodyState& bodies, double dt) const;

  model::Settings settings_;
  Springs springs_;
};

}  // namespace gotai::impulse
