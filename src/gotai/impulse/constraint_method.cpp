#include "gotai/impulse/constraint_method.h"

#include "gotai/impulse/step_plans.h"
#include "gotai/impulse/warm_start.h"

namespace gotai::impulse {

ConstraintMethod::ConstraintMethod(const model::Settings& settings)
    : settings_(settings), islands_(settings) {}

model::StepPlan ConstraintMethod::plan(const model::BodyState& bodies, double dt) const {
  model::StepPlan plan = whole_step(settings_, dt);
  // The thesis lets spheres touch first.
  if (settings_.collision.model == model::CollisionModel::surface) {
    plan.contact_margin = approach_margin(bodies, settings_.gravity, dt);
  }
  return plan;
}

void ConstraintMethod::prepare(const model::BodyState& bodies, const model::ContactSet& contacts,
                               const model::MaterialTable& materials, const model::StepPlan& plan,
                               const model::ContactMemory& memory) {
  contacts_ = &contacts;
  dt_ = plan.dt;
  read_targets(bodies, contacts, materials, targets_);
  slide_friction(bodies, contacts, settings_.gravity.norm() * plan.dt, targets_);
  islands_.prepare(bodies, contacts, memory);
}

void ConstraintMethod::solve(const model::BodyState& bodies, const std::vector<double>& gap,
                             model::Update& update) {
  islands_.solve(bodies, targets_, gap, dt_, update);
}

void ConstraintMethod::finish(const model::BodyState& /*bodies*/, model::Update& update,
                              model::ContactMemory& memory) {
  remember(*contacts_, update.contact_impulse, memory);
}

}  // namespace gotai::impulse
