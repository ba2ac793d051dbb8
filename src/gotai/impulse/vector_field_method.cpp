#include "gotai/impulse/vector_field_method.h"

#include <algorithm>
#include <cmath>

namespace gotai::impulse {
namespace {

constexpr double largest_phase = 0.2;  // w h; semi-implicit Euler is stable up to 2

// delta = 2 s with the voxel edge s = 2 r / sqrt(3) [m].
double range(double voxel_radius) { return 4.0 * voxel_radius / std::sqrt(3.0); }

// k / (m delta) = 4 |g| rho / delta^2 as an angular frequency [rad/s].
double frequency(double gravity, double bounding_radius, double delta) {
  return std::sqrt(4.0 * gravity * bounding_radius) / delta;
}

}  // namespace

VectorFieldMethod::VectorFieldMethod(const model::Settings& settings) : settings_(settings) {}

model::StepPlan VectorFieldMethod::plan(const model::BodyState& bodies, double dt) const {
  model::StepPlan plan;
  plan.dt = dt;
  plan.refresh_contacts = true;
  plan.positions_first = settings_.time.integrator == model::Integrator::explicit_euler;
  double highest = 0.0;
  for (model::BodyIndex i = 0; i < bodies.size(); ++i) {
    if (!bodies.is_dynamic(i)) continue;
    const double delta = range(bodies.voxel_radius[i]);
    plan.contact_margin = std::max(plan.contact_margin, delta);
    highest =
        std::max(highest, frequency(settings_.gravity.norm(), bodies.bounding_radius[i], delta));
  }
  const double phase = dt * highest * std::sqrt(largest_leverage(bodies));
  plan.substeps = std::max(1, static_cast<int>(std::ceil(phase / largest_phase)));
  return plan;
}

void VectorFieldMethod::prepare(const model::BodyState& bodies, const model::ContactSet& contacts,
                                const model::MaterialTable& materials, const model::StepPlan& plan,
                                const model::ContactMemory& /*memory*/) {
  contacts_ = &contacts;
  substep_ = plan.substep_dt();
  springs_.clear();
  for (const model::ContactPair& pair : contacts.pairs) {
    const model::SurfacePair surface =
        materials.combine(bodies.material[pair.body_a], bodies.material[pair.body_b]);
    PairSpring spring;
    for (const model::BodyIndex i : {pair.body_a, pair.body_b}) {
      if (!bodies.is_dynamic(i)) continue;
      const double delta = range(bodies.voxel_radius[i]);
      spring.rest_gap = std::max(spring.rest_gap, delta);
      spring.frequency = std::max(
          spring.frequency, frequency(settings_.gravity.norm(), bodies.bounding_radius[i], delta));
    }
    spring.damping_ratio = damping_ratio(surface.restitution);
    spring.friction = surface.friction;
    springs_.push_back(spring);
  }
  normal_impulse_.assign(contacts.size(), 0.0);
  report_ = {};
  report_.substeps = static_cast<std::uint32_t>(plan.substeps);
}

void VectorFieldMethod::solve(const model::BodyState& bodies, const std::vector<double>& gap,
                              model::Update& update) {
  before_.read(bodies);
  velocities_.read(bodies);
  std::uint32_t active = 0;
  for (std::size_t k = 0; k < springs_.size(); ++k) {
    active +=
        add_spring_impulses(bodies, *contacts_, contacts_->pairs[k], springs_[k], gap, substep_,
                            before_, velocities_, normal_impulse_, update.contact_impulse);
  }
  report_.rows = std::max(report_.rows, active);
  velocities_.write_changes(bodies, update);
}

void VectorFieldMethod::finish(const model::BodyState& /*bodies*/, model::Update& /*update*/,
                               model::ContactMemory& memory) {
  memory.entries.clear();
}

}  // namespace gotai::impulse
