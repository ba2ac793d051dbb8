/// @file
/// The constraint-based method, the thesis's choice [Makino 2007, sections 2.4-2.7, 4.3].
#pragma once

#include "gotai/impulse/assembly.h"
#include "gotai/impulse/island_solver.h"
#include "gotai/impulse/method.h"

namespace gotai::impulse {

/// Solves all contacts of an island together: 0 <= p _|_ A p + q >= 0 with Coulomb's friction.
///
/// Reads every contact that touches, and those that come close within the step.
/// Guarantees: no contact approaches afterwards (up to the residual, which is reported); every
/// approaching contact separates with at least e times its speed; friction within the cone, opposed
/// to sliding, never reversing it; no energy gain without friction (at one restitution per island)
/// or without restitution; redundant contacts share the load evenly, by area; the same bits for any
/// number of threads.
/// Does not: propagate shocks one after the other (Newton's cradle leaves with -1/3, 2/3, 2/3;
/// erratum 48), nor undo overlap. What the energy of the scheme,
/// T + U + dt/2 sum m g.v, can gain: m (g dt)^2 / 8 when a contact catches a body at the top of its
/// flight (there the scheme counts so much less than at rest); and a little in oblique impacts with
/// both friction and restitution, as by Newton's impact law (Kane & Levinson 1985).
class ConstraintMethod : public ImpulseMethod {
 public:
  explicit ConstraintMethod(const model::Settings& settings);

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
