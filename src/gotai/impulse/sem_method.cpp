#include "gotai/impulse/sem_method.h"

#include "gotai/impulse/step_plans.h"
#include "gotai/impulse/warm_start.h"

namespace gotai::impulse {

SemMethod::SemMethod(const model::Settings& settings) : settings_(settings), islands_(settings) {}

model::StepPlan SemMethod::plan(const model::BodyState& /*bodies*/, double dt) const {
  return whole_step(settings_, dt);
}

void SemMethod::prepare(const model::BodyState& bodies, const model::ContactSet& contacts,
                        const model::MaterialTable& /*materials*/, const model::StepPlan& plan,
                        const model::ContactMemory& memory) {
  contacts_ = &contacts;
  dt_ = plan.dt;
  targets_.approach.assign(contacts.size(), 0.0);
  targets_.restitution.assign(contacts.size(), 0.0);
  targets_.friction.assign(contacts.size(), ConeProblem::unlimited);
  targets_.friction_W = contacts.friction_W;
  islands_.prepare(bodies, contacts, memory);
}

void SemMethod::solve(const model::BodyState& bodies, const std::vector<double>& gap,
                      model::Update& update) {
  islands_.solve(bodies, targets_, gap, dt_, update);
}

void SemMethod::finish(const model::BodyState& /*bodies*/, model::Update& update,
                       model::ContactMemory& memory) {
  remember(*contacts_, update.contact_impulse, memory);
}

}  // namespace gotai::impulse
