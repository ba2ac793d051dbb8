#include "gotai/world/measure.h"

#include <algorithm>

namespace gotai {

model::Energy measure_energy(const model::BodyState& bodies, const model::Settings& settings,
                             double h) {
  const bool semi_implicit = settings.time.integrator == model::Integrator::semi_implicit;
  const double correction_factor = (semi_implicit ? 0.5 : -0.5) * h;
  model::Energy energy;
  for (model::BodyIndex i = 0; i < bodies.size(); ++i) {
    if (!bodies.is_dynamic(i)) continue;
    const double mass = 1.0 / bodies.inverse_mass[i];
    energy.kinetic += 0.5 * mass * bodies.v_W[i].squaredNorm();
    energy.kinetic += 0.5 * bodies.w_W[i].dot(bodies.L_W[i]);
    energy.potential -= mass * settings.gravity.dot(bodies.x_W[i]);
    energy.correction += correction_factor * mass * settings.gravity.dot(bodies.v_W[i]);
  }
  return energy;
}

void measure_contacts(const model::ContactSet& contacts, model::StepReport& report) {
  report.pairs = static_cast<std::uint32_t>(contacts.pairs.size());
  report.contacts = static_cast<std::uint32_t>(contacts.size());
  double sum = 0.0;
  std::size_t overlapping = 0;
  for (const double gap : contacts.gap) {
    if (gap >= 0.0) continue;
    sum -= gap;
    ++overlapping;
    report.max_overlap = std::max(report.max_overlap, -gap);
  }
  report.mean_overlap = overlapping > 0 ? sum / static_cast<double>(overlapping) : 0.0;
}

}  // namespace gotai
