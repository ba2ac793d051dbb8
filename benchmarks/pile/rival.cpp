#include "pile/rival.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "gotai/core/error.h"
#include "gotai/geometry/mass_properties.h"

namespace gotai::pile {
namespace {

// Of all bodies, with the correction of a semi-implicit step, as in World::energy().
double energy_of(const std::vector<Motion>& motions, const geometry::MassProperties& at_density_1) {
  const double mass = kDensity * at_density_1.volume;
  const Mat3 inertia = kDensity * at_density_1.inertia;
  double sum = 0.0;
  for (const Motion& body : motions) {
    const Vec3 w_B = body.q_WM.conjugate() * body.w_W;
    sum += 0.5 * mass * body.v_W.squaredNorm() + 0.5 * w_B.dot(inertia * w_B) +
           mass * 9.81 * (body.x_W.z() - 0.5 * kStep * body.v_W.z());
  }
  return sum;
}

}  // namespace

Result simulate(const Options& o, const Pile& pile, const Rival& rival) {
  const geometry::MassProperties properties = geometry::mass_properties(pile.mesh);
  Result result;
  result.engine = rival.name;
  const double initial = energy_of(rival.motions(), properties);
  double highest = initial;
  const int steps = static_cast<int>(std::lround(o.seconds / kStep));
  const int rest_steps = std::min(steps, static_cast<int>(std::lround(1.0 / kStep)));
  double contacts_before = 0.0;  // the last second
  for (int s = 0; s < steps; ++s) {
    if (s == steps - rest_steps) contacts_before = *rival.contacts;
    const double start = cpu_seconds();
    rival.step();
    const double ms = 1e3 * (cpu_seconds() - start);
    result.ms_per_step += ms / steps;
    if (s >= steps - rest_steps) result.ms_last_second += ms / rest_steps;
    result.ms_worst = std::max(result.ms_worst, ms);
    highest = std::max(highest, energy_of(rival.motions(), properties));
    if (o.verbose && (s + 1) % 30 == 0) {
      fmt::print("  t {:5.2f} s  {:7.2f} ms\n", (s + 1) * kStep, ms);
      std::fflush(stdout);
    }
  }
  result.contacts = *rival.contacts / std::max(1, steps);
  result.us_per_contact = 1e3 * result.ms_per_step / std::max(1.0, result.contacts);
  result.us_per_contact_last_second =
      1e3 * result.ms_last_second * rest_steps / std::max(1.0, *rival.contacts - contacts_before);
  result.energy_gain = (highest - initial) / std::abs(initial);
  double squares = 0.0;
  for (const Motion& body : rival.motions()) {
    result.poses.push_back({body.x_W - body.q_WM * properties.center_of_mass, body.q_WM});
    squares += body.v_W.squaredNorm();
  }
  const auto count = static_cast<double>(result.poses.size());
  result.rms_speed = std::sqrt(squares / std::max(1.0, count));
  return result;
}

const std::vector<std::string>& rivals() {
  static const std::vector<std::string> names = {"ode", "bullet"};
  return names;
}

Result run_rival(const std::string& name, const Options& options, const Pile& pile) {
  return name == "ode" ? run_ode(options, pile) : run_bullet(options, pile);
}

void require_rival(const std::string& name) {
  if (std::ranges::find(rivals(), name) == rivals().end())
    throw InvalidArgument("--compare", name, "must be ode or bullet");
  if (name == "ode" ? !has_ode() : !has_bullet()) {
    throw InvalidArgument("--compare", name,
                          "is not in this build: scripts/setup --benchmarks, then configure again");
  }
}

}  // namespace gotai::pile
