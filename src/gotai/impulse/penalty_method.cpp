#include "gotai/impulse/penalty_method.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "gotai/impulse/step_plans.h"

namespace gotai::impulse {

PenaltyMethod::PenaltyMethod(const model::Settings& settings) : settings_(settings) {}

double PenaltyMethod::frequency(const model::BodyState& bodies, double dt) const {
  double smallest = std::numeric_limits<double>::infinity();
  for (model::BodyIndex i = 0; i < bodies.size(); ++i) {
    if (bodies.is_dynamic(i)) smallest = std::min(smallest, bodies.bounding_radius[i]);
  }
  return std::max(std::numbers::pi / dt,
                  std::sqrt(settings_.gravity.norm() / (settings_.impulse.penetration * smallest)));
}

model::StepPlan PenaltyMethod::plan(const model::BodyState& bodies, double dt) const {
  model::StepPlan plan = whole_step(settings_, dt);
  plan.contact_margin = approach_margin(bodies, settings_.gravity, dt);
  plan.refresh_contacts = true;
  plan.substeps = substeps_for_springs(bodies, frequency(bodies, dt), dt);
  return plan;
}

void PenaltyMethod::prepare(const model::BodyState& bodies, const model::ContactSet& contacts,
                            const model::MaterialTable& materials, const model::StepPlan& plan,
                            const model::ContactMemory& /*memory*/) {
  PairSpring spring;
  spring.frequency = frequency(bodies, plan.dt);
  spring.tension = settings_.impulse.tension;
  springs_.prepare(bodies, contacts, materials, plan,
                   [&](const model::ContactPair& /*pair*/) { return spring; });
}

void PenaltyMethod::solve(const model::BodyState& bodies, const std::vector<double>& gap,
                          model::Update& update) {
  springs_.solve(bodies, gap, update);
}

void PenaltyMethod::finish(const model::BodyState& /*bodies*/, model::Update& /*update*/,
                           model::ContactMemory& memory) {
  memory.entries.clear();
}

}  // namespace gotai::impulse
