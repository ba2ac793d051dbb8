#include "gotai/world/run_summary.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gotai/dynamics/step_control.h"
#include "gotai/world/measure.h"
#include "gotai/world/world.h"

namespace gotai {
namespace {

// Sum of m |v| over the dynamic bodies: the scale of their momentum.
double momentum_scale(const model::BodyState& bodies) {
  double sum = 0.0;
  for (model::BodyIndex i = 0; i < bodies.size(); ++i) {
    if (bodies.is_dynamic(i)) sum += bodies.v_W[i].norm() / bodies.inverse_mass[i];
  }
  return sum;
}

double dynamic_mass(const model::BodyState& bodies) {
  double sum = 0.0;
  for (model::BodyIndex i = 0; i < bodies.size(); ++i) {
    if (bodies.is_dynamic(i)) sum += 1.0 / bodies.inverse_mass[i];
  }
  return sum;
}

// What fixed and kinematic bodies gave to the dynamic ones in the last step [N s].
Vec3 impulse_from_outside(const World& world) {
  const model::BodyState& bodies = world.bodies();
  const model::ContactSet& contacts = world.contacts();
  Vec3 sum = Vec3::Zero();
  for (const model::ContactPair& pair : contacts.pairs) {
    if (bodies.is_dynamic(pair.body_a) && bodies.is_dynamic(pair.body_b)) continue;
    for (std::uint32_t c = pair.begin; c < pair.end; ++c) sum += world.contact_impulses()[c];
  }
  return sum;
}

// Is a point inside the solid of a plane or container?
bool is_inside_solid(const model::BodyState& bodies, model::BodyIndex solid, const Vec3& x_W) {
  const Vec3 x = bodies.q_WB[solid].conjugate() * (x_W - bodies.x_W[solid]);
  switch (bodies.geometry[solid]) {
    case model::Geometry::plane:
      return x.z() < 0.0;
    case model::Geometry::container: {
      const Vec3& half = bodies.half_extent[solid];
      return x.z() < 0.0 ||
             (x.z() < half.z() && (std::abs(x.x()) > half.x() || std::abs(x.y()) > half.y()));
    }
    case model::Geometry::shape:
      return false;
  }
  return false;
}

std::uint64_t count_escaped(const model::BodyState& bodies) {
  std::uint64_t escaped = 0;
  for (model::BodyIndex i = 0; i < bodies.size(); ++i) {
    if (!bodies.is_dynamic(i)) continue;
    for (model::BodyIndex solid = 0; solid < bodies.size(); ++solid) {
      if (is_inside_solid(bodies, solid, bodies.x_W[i])) {
        ++escaped;
        break;
      }
    }
  }
  return escaped;
}

// The step in which no surface point of a dynamic body moves farther than a voxel's radius [s].
double safe_step(const World& world) {
  model::Settings settings = world.settings();
  settings.time.safety = 1.0;
  settings.time.max_step = std::numeric_limits<double>::infinity();
  return dynamics::derived_step(world.bodies(), settings);
}

double ratio(double sum, double count) { return count > 0.0 ? sum / count : 0.0; }

}  // namespace

RunMonitor::RunMonitor(const World& world)
    : start_time_(world.time()),
      energy_(measure_energy(world.bodies(), world.settings(), 1.0)),
      momentum_(world.momentum()),
      largest_momentum_(momentum_scale(world.bodies())),
      next_safe_step_(safe_step(world)) {
  totals_.energy.initial = world.energy().total();
}

void RunMonitor::on_step(const World& world, const model::StepReport& report) {
  ++totals_.steps;
  step_times_.push_back(report.time);
  step_seconds_.push_back(report.total_s());
  totals_.phase_ms.collision += 1e3 * report.collision_s;
  totals_.phase_ms.impulse += 1e3 * report.impulse_s;
  totals_.phase_ms.integration += 1e3 * report.integration_s;
  totals_.phase_ms.other += 1e3 * report.other_s;

  totals_.contacts.mean += report.contacts;
  totals_.contacts.max = std::max<std::uint64_t>(totals_.contacts.max, report.contacts);
  totals_.overlap.max = std::max(totals_.overlap.max, report.max_overlap);
  overlap_sum_ += report.mean_overlap * report.contacts;
  totals_.step_margin = std::min(totals_.step_margin, next_safe_step_ / report.dt);
  next_safe_step_ = safe_step(world);
  totals_.residual_max = std::max(totals_.residual_max, report.solve.residual);
  totals_.plastic_islands += report.solve.plastic_islands;
  totals_.substeps_max = std::max<std::uint64_t>(totals_.substeps_max, report.solve.substeps);

  // The correction before the step refers to this step's sub-steps, not to the last one's.
  const double h = report.dt / report.solve.substeps;
  const double before = energy_.kinetic + energy_.potential + energy_.correction * h;
  if (totals_.steps == 1) totals_.energy.initial = before;
  energy_change_ += report.energy.total() - before;
  lowest_change_ = std::min(lowest_change_, energy_change_);
  totals_.energy.max_gain = std::max(totals_.energy.max_gain, energy_change_ - lowest_change_);
  energy_ = report.energy;
  energy_.correction /= h;

  const Vec3 momentum = world.momentum();
  const Vec3 gravity_impulse = dynamic_mass(world.bodies()) * report.dt * world.settings().gravity;
  const Vec3 defect = momentum - momentum_ - gravity_impulse - impulse_from_outside(world);
  momentum_defect_ = std::max(momentum_defect_, defect.norm());
  momentum_ = momentum;
  largest_momentum_ = std::max(largest_momentum_, momentum_scale(world.bodies()));
}

RunSummary RunMonitor::summary(const World& world, double wall_s) const {
  RunSummary s = totals_;
  const model::BodyState& bodies = world.bodies();
  s.bodies = static_cast<std::uint64_t>(
      std::count(bodies.geometry.begin(), bodies.geometry.end(), model::Geometry::shape));
  s.simulated_s = world.time() - start_time_;
  s.wall_s = wall_s;

  const auto steps = static_cast<double>(s.steps);
  for (double* sum :
       {&s.phase_ms.collision, &s.phase_ms.impulse, &s.phase_ms.integration, &s.phase_ms.other}) {
    *sum = ratio(*sum, steps);
  }
  double last_second = 0.0;
  std::size_t last_second_steps = 0;
  double all = 0.0;
  for (std::size_t i = 0; i < step_seconds_.size(); ++i) {
    all += step_seconds_[i];
    if (step_times_[i] > world.time() - 1.0) {
      last_second += step_seconds_[i];
      ++last_second_steps;
    }
  }
  s.step_ms.mean = 1e3 * ratio(all, steps);
  s.step_ms.last_second_mean = 1e3 * ratio(last_second, static_cast<double>(last_second_steps));
  if (!step_seconds_.empty()) {
    std::vector<double> sorted = step_seconds_;
    std::sort(sorted.begin(), sorted.end());
    s.step_ms.p95 = 1e3 * sorted[(sorted.size() * 95 + 99) / 100 - 1];
    s.step_ms.max = 1e3 * sorted.back();
  }
  s.overlap.mean = ratio(overlap_sum_, s.contacts.mean);
  s.contacts.mean = ratio(s.contacts.mean, steps);
  s.energy.final = world.energy().total();
  s.momentum_error = ratio(momentum_defect_, largest_momentum_);
  s.true_overlap = measure_true_overlap(bodies, world.shapes());
  s.escaped = count_escaped(bodies);
  s.state_hash = world.state_hash().hex();
  return s;
}

}  // namespace gotai
