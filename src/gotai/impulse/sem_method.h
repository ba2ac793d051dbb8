/// @file
/// System energy minimisation [Makino 2007, sections 2.3.4, 4.2; eqs. 2.8, 2.9, 4.1-4.5].
#pragma once

#include "gotai/impulse/island_solver.h"
#include "gotai/impulse/method.h"

namespace gotai::impulse {

/// Finds the contact forces f, three components per contact with f_n >= 0, that minimise the
/// system's energy over the step (with p = f dt and V* the velocities with gravity):
///   min 1/2 p' (J M^-1 J') p + (J V*)' p.
///
/// Reads every contact that touches.
/// Guarantees: no contact approaches and none slides afterwards (v' = 0 where it approached, eqs.
/// 4.4, 4.5); never gains energy. Does not: bounce, or slide: it sticks, whatever restitution and
/// friction the materials have, also sideways at a contact that separates while it still touches.
class SemMethod final : public ImpulseMethod {
 public:
  explicit SemMethod(const model::Settings& settings);

  model::StepPlan plan(const model::BodyState& bodies, double dt) const override;
  void prepare(const model::BodyState& bodies, const model::ContactSet& contacts,
               const model::MaterialTable& materials, const model::StepPlan& plan,
               const model::ContactMemory& memory) override;
  void solve(const model::BodyState& bodies, const std::vector<double>& gap,
             model::Update& update) override;
  void finish(const model::BodyState& bodies, model::Update& update,
              model::ContactMemory& memory) override;
  model::SolveReport report() const override { return islands_.report(); }

 private:
  model::Settings settings_;
  IslandSolver islands_;
  const model::ContactSet* contacts_ = nullptr;  // of the step
  ContactTargets targets_;
  double dt_ = 0.0;
};

}  // namespace gotai::impulse
