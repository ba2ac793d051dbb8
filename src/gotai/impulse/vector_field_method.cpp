#include "gotai/impulse/vector_field_method.h"

#include <algorithm>
#include <cmath>

#include "gotai/impulse/step_plans.h"

namespace gotai::impulse {
namespace {

// delta = 2 s with the voxel edge s = 2 r / sqrt(3) [m].
double range(double voxel_radius) { return 4.0 * voxel_radius / std::sqrt(3.0); }

// k / (m delta) = 4 |g| rho / delta^2 as an angular frequency [rad/s].
double frequency(double gravity, double bounding_radius, double delta) {
  return std::sqrt(4.0 * gravity * bounding_radius) / delta;
}

}  // namespace

VectorFieldMethod::VectorFieldMethod(const model::Settings& settings) : settings_(settings) {}

model::StepPlan VectorFieldMethod::plan(const model::BodyState& bodies, double dt) const {
  model::StepPlan plan = whole_step(settings_, dt);
  plan.refresh_contacts = true;
  double highest = 0.0;
  for (model::BodyIndex i = 0; i < bodies.size(); ++i) {
    if (!bodies.is_dynamic(i)) continue;
    const double delta = range(bodies.voxel_radius[i]);
    plan.contact_margin = std::max(plan.contact_margin, delta);
    highest =
        std::max(highest, frequency(settings_.gravity.norm(), bodies.bounding_radius[i], delta));
  }
  plan.substeps = substeps_for_springs(bodies, highest, dt);
  return plan;
}

void VectorFieldMethod::prepare(const model::BodyState& bodies, const model::ContactSet& contacts,
                                const model::MaterialTable& materials, const model::StepPlan& plan,
                                const model::ContactMemory& /*memory*/) {
  springs_.prepare(bodies, contacts, materials, plan, [&](const model::ContactPair& pair) {
    PairSpring spring;
    for (const model::BodyIndex i : {pair.body_a, pair.body_b}) {
      if (!bodies.is_dynamic(i)) continue;
      const double delta = range(bodies.voxel_radius[i]);
      spring.rest_gap = std::max(spring.rest_gap, delta);
      spring.frequency = std::max(
          spring.frequency, frequency(settings_.gravity.norm(), bodies.bounding_radius[i], delta));
    }
    return spring;
  });
}

void VectorFieldMethod::solve(const model::BodyState& bodies, const std::vector<double>& gap,
                              model::Update& update) {
  springs_.solve(bodies, gap, update);
}

void VectorFieldMethod::finish(const model::BodyState& /*bodies*/, model::Update& /*update*/,
                               model::ContactMemory& memory) {
  memory.entries.clear();
}

}  // namespace gotai::impulse
