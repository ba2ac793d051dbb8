#include "gotai/impulse/penalty_method.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace gotai::impulse {
namespace {

// Semi-implicit Euler is stable up to w h = 2; a tenth of it follows the spring closely.
constexpr double largest_phase = 0.2;
// Allowed penetration at rest, as a fraction of the smallest body's bounding radius.
constexpr double resting_penetration = 1e-3;

}  // namespace

PenaltyMethod::PenaltyMethod(const model::Settings& settings, bool tension)
    : settings_(settings), tension_(tension) {}

double PenaltyMethod::frequency(const model::BodyState& bodies, double dt) const {
  double smallest = std::numeric_limits<double>::infinity();
  for (model::BodyIndex i = 0; i < bodies.size(); ++i) {
    if (bodies.is_dynamic(i)) smallest = std::min(smallest, bodies.bounding_radius[i]);
  }
  return std::max(std::numbers::pi / dt,
                  std::sqrt(settings_.gravity.norm() / (resting_penetration * smallest)));
}

model::StepPlan PenaltyMethod::plan(const model::BodyState& bodies, double dt) const {
  double fastest = 0.0;
  for (model::BodyIndex i = 0; i < bodies.size(); ++i) {
    if (bodies.kind[i] == model::BodyKind::fixed) continue;
    fastest =
        std::max(fastest, bodies.v_W[i].norm() + bodies.bounding_radius[i] * bodies.w_W[i].norm());
  }
  model::StepPlan plan;
  plan.dt = dt;
  plan.contact_margin = 2.0 * dt * (fastest + settings_.gravity.norm() * dt);
  plan.refresh_contacts = true;
  plan.positions_first = settings_.time.integrator == model::Integrator::explicit_euler;
  const double phase = dt * frequency(bodies, dt) * std::sqrt(largest_leverage(bodies));
  plan.substeps = std::max(1, static_cast<int>(std::ceil(phase / largest_phase)));
  return plan;
}

void PenaltyMethod::prepare(const model::BodyState& bodies, const model::ContactSet& contacts,
                            const model::MaterialTable& materials, const model::StepPlan& plan,
                            const model::ContactMemory& /*memory*/) {
  contacts_ = &contacts;
  substep_ = plan.substep_dt();
  springs_.clear();
  for (const model::ContactPair& pair : contacts.pairs) {
    const model::SurfacePair surface =
        materials.combine(bodies.material[pair.body_a], bodies.material[pair.body_b]);
    PairSpring spring;
    spring.frequency = frequency(bodies, plan.dt);
    spring.damping_ratio = damping_ratio(surface.restitution);
    spring.friction = surface.friction;
    spring.tension = tension_;
    springs_.push_back(spring);
  }
  normal_impulse_.assign(contacts.size(), 0.0);
  report_ = {};
  report_.substeps = static_cast<std::uint32_t>(plan.substeps);
}

void PenaltyMethod::solve(const model::BodyState& bodies, const std::vector<double>& gap,
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

void PenaltyMethod::finish(const model::BodyState& /*bodies*/, model::Update& /*update*/,
                           model::ContactMemory& memory) {
  memory.entries.clear();
}

}  // namespace gotai::impulse
