#include "gotai/impulse/constraint_method.h"

#include <algorithm>

#include "gotai/impulse/warm_start.h"

namespace gotai::impulse {
namespace {

// How far contacts must be seen before they touch [m]. Spheres: the thesis lets them touch first.
double margin(const model::Settings& settings, const model::BodyState& bodies, double dt) {
  if (settings.collision.model == model::CollisionModel::spheres) return 0.0;
  double fastest = 0.0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies.kind[i] == model::BodyKind::fixed) continue;
    fastest =
        std::max(fastest, bodies.v_W[i].norm() + bodies.bounding_radius[i] * bodies.w_W[i].norm());
  }
  return 2.0 * dt * (fastest + settings.gravity.norm() * dt);
}

}  // namespace

ConstraintMethod::ConstraintMethod(const model::Settings& settings)
    : settings_(settings), islands_(settings) {}

model::StepPlan ConstraintMethod::plan(const model::BodyState& bodies, double dt) const {
  model::StepPlan plan;
  plan.dt = dt;
  plan.contact_margin = margin(settings_, bodies, dt);
  plan.positions_first = settings_.time.integrator == model::Integrator::explicit_euler;
  return plan;
}

void ConstraintMethod::prepare(const model::BodyState& bodies, const model::ContactSet& contacts,
                               const model::MaterialTable& materials, const model::StepPlan& plan,
                               const model::ContactMemory& memory) {
  contacts_ = &contacts;
  dt_ = plan.dt;
  read_targets(bodies, contacts, materials, targets_);
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
