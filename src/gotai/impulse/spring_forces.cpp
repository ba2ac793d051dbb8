#include "gotai/impulse/spring_forces.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gotai::impulse {

double damping_ratio(double restitution) {
  if (restitution <= 0.0) return 1.0;
  const double decay = -std::log(restitution);
  return decay / std::hypot(std::numbers::pi, decay);
}

double reduced_mass(const model::BodyState& bodies, const model::ContactPair& pair) {
  return 1.0 / (bodies.inverse_mass[pair.body_a] + bodies.inverse_mass[pair.body_b]);
}

double largest_leverage(const model::BodyState& bodies) {
  double largest = 1.0;
  for (model::BodyIndex i = 0; i < bodies.size(); ++i) {
    if (!bodies.is_dynamic(i)) continue;
    const double arm = bodies.bounding_radius[i];
    const double smallest_moment = bodies.principal_moments[i].minCoeff();
    largest = std::max(largest, 1.0 + arm * arm / (bodies.inverse_mass[i] * smallest_moment));
  }
  return largest;
}

std::uint32_t add_spring_impulses(const model::BodyState& bodies, const model::ContactSet& contacts,
                                  const model::ContactPair& pair, const PairSpring& spring,
                                  const std::vector<double>& gap, double step,
                                  const WorkingVelocities& before, WorkingVelocities& velocities,
                                  std::vector<double>& normal_impulse,
                                  std::vector<Vec3>& contact_impulse) {
  std::uint32_t active = 0;
  for (std::uint32_t i = pair.begin; i < pair.end; ++i) {
    normal_impulse[i] = 0.0;
    if (gap[i] < spring.rest_gap) ++active;
  }
  if (active == 0) return 0;

  const double mass = reduced_mass(bodies, pair) / active;
  const double stiffness = mass * spring.frequency * spring.frequency;
  const double damping = 2.0 * spring.damping_ratio * mass * spring.frequency;
  for (std::uint32_t i = pair.begin; i < pair.end; ++i) {
    if (gap[i] >= spring.rest_gap) continue;
    const Vec3& n = contacts.normal_W[i];
    const double v = n.dot(before.relative(bodies, pair, contacts.point_W[i]));
    double force = stiffness * (spring.rest_gap - gap[i]) - damping * v;
    if (!spring.tension) force = std::max(0.0, force);
    normal_impulse[i] = force * step;
    const Vec3 impulse = normal_impulse[i] * n;
    velocities.add_impulse(bodies, pair, contacts.point_W[i], impulse);
    contact_impulse[i] += impulse;
  }
  add_patch_friction(bodies, contacts, pair, spring.friction, normal_impulse, velocities,
                     contact_impulse);
  return active;
}

void Springs::start(const model::ContactSet& contacts, const model::StepPlan& plan) {
  contacts_ = &contacts;
  substep_ = plan.substep_dt();
  springs_.clear();
  normal_impulse_.assign(contacts.size(), 0.0);
  report_ = {};
  report_.substeps = static_cast<std::uint32_t>(plan.substeps);
}

void Springs::solve(const model::BodyState& bodies, const std::vector<double>& gap,
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

int substeps_for_springs(const model::BodyState& bodies, double frequency, double dt) {
  // Semi-implicit Euler is stable up to w h = 2; a tenth of it follows the spring closely.
  constexpr double largest_phase = 0.2;
  if (dt <= 0.0) return 1;  // the frequency may be that of the step, without bound
  const double phase = dt * frequency * std::sqrt(largest_leverage(bodies));
  return std::max(1, static_cast<int>(std::ceil(phase / largest_phase)));
}

}  // namespace gotai::impulse
