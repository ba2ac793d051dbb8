#include "gotai/impulse/step_plans.h"

#include <algorithm>

namespace gotai::impulse {

model::StepPlan whole_step(const model::Settings& settings, double dt) {
  model::StepPlan plan;
  plan.dt = dt;
  plan.positions_first = settings.time.integrator == model::Integrator::explicit_euler;
  return plan;
}

double approach_margin(const model::BodyState& bodies, const Vec3& gravity, double dt) {
  double fastest = 0.0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies.kind[i] == model::BodyKind::fixed) continue;
    fastest =
        std::max(fastest, bodies.v_W[i].norm() + bodies.bounding_radius[i] * bodies.w_W[i].norm());
  }
  return 2.0 * dt * (fastest + gravity.norm() * dt);
}

}  // namespace gotai::impulse
