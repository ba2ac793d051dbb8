#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <span>

#include "gotai/core/error.h"
#include "gotai/core/parallel.h"
#include "pile/pile.h"

namespace gotai::pile {
namespace {

double rms_speed(const model::BodyState& bodies) {
  double sum = 0.0;
  double count = 0.0;
  for (model::BodyIndex i = 0; i < bodies.size(); ++i) {
    if (!bodies.is_dynamic(i)) continue;
    sum += bodies.v_W[i].squaredNorm();
    count += 1.0;
  }
  return std::sqrt(sum / std::max(1.0, count));
}

// Of one step [ms].
struct StepTimes {
  double collision = 0.0, impulse = 0.0, integration = 0.0, other = 0.0;  // wall-clock
  double cpu = 0.0;
  double contacts = 0.0, tests = 0.0;

  void take_least(const StepTimes& again) {
    for (double StepTimes::*time : {&StepTimes::collision, &StepTimes::impulse,
                                    &StepTimes::integration, &StepTimes::other, &StepTimes::cpu})
      this->*time = std::min(this->*time, again.*time);
  }
  void add(const StepTimes& step) {
    for (double StepTimes::*entry :
         {&StepTimes::collision, &StepTimes::impulse, &StepTimes::integration, &StepTimes::other,
          &StepTimes::cpu, &StepTimes::contacts, &StepTimes::tests})
      this->*entry += step.*entry;
  }
};

StepTimes sum_of(std::span<const StepTimes> steps) {
  StepTimes sum;
  for (const StepTimes& step : steps) sum.add(step);
  return sum;
}

void print_phases(const char* name, std::span<const StepTimes> steps) {
  const StepTimes sum = sum_of(steps);
  const auto n = static_cast<double>(std::max<std::size_t>(1, steps.size()));
  fmt::print(
      "{:<12} collision {:7.3f}  impulse {:7.3f}  integration {:7.3f}  other {:7.3f}  sum {:7.3f}  "
      "contacts {:6.0f}  tests {:8.0f}\n",
      name, sum.collision / n, sum.impulse / n, sum.integration / n, sum.other / n,
      (sum.collision + sum.impulse + sum.integration + sum.other) / n, sum.contacts / n,
      sum.tests / n);
}

// One run, and what its steps took.
struct Run {
  World world;
  std::vector<StepTimes> steps;
  std::size_t at_rest = 0;  // the first step of the last second
  double energy_gain = 0.0;
};

Run run_once(const Options& o, const Pile& pile, const ShapePointer& shape) {
  Run run{make_world(o, pile, shape), {}};
  const World& world = run.world;
  const double initial = world.energy().total();
  double highest = initial;
  while (!world.has_reached(o.seconds)) {
    const double start = cpu_seconds();
    const model::StepReport r = run.world.step();
    const double cpu = cpu_seconds() - start;
    run.steps.push_back({1e3 * r.collision_s, 1e3 * r.impulse_s, 1e3 * r.integration_s,
                         1e3 * r.other_s, 1e3 * cpu, static_cast<double>(r.contacts),
                         static_cast<double>(r.tests)});
    if (world.time() <= o.seconds - 1.0) run.at_rest = run.steps.size();
    highest = std::max(highest, r.energy.total());
    if (o.verbose && world.step_count() % 30 == 0) {
      fmt::print("  t {:5.2f} s  {:7.2f} ms  contacts {:6}  overlap {:.1e} m  rms speed {:.1e}\n",
                 world.time(), 1e3 * cpu, r.contacts, r.max_overlap, rms_speed(world.bodies()));
      std::fflush(stdout);
    }
  }
  run.energy_gain = (highest - initial) / std::abs(initial);
  return run;
}

}  // namespace

ShapePointer make_pile_shape(const Options& o, const Pile& pile) {
  return std::make_shared<const voxel::Shape>(
      voxel::make_shape(o.mesh, pile.mesh, {.prepared_level = o.level, .surface_level = o.level}));
}

World make_world(const Options& o, const Pile& pile, const ShapePointer& prepared) {
  model::Settings settings;
  settings.collision.model = model::CollisionModel::surface;
  settings.collision.level = o.level;
  settings.impulse.contacts = o.contacts;
  settings.impulse.rolling_resistance = o.rolling_resistance;
  settings.time.step = kStep;
  World world(settings);
  model::Material material;
  material.friction = kFriction;
  material.restitution = kRestitution;
  world.set_default_material(material);
  const ShapeId shape = world.add_shape(prepared);
  world.add_container({.name = "container", .inner = pile.inner});
  for (const Pose& X : pile.poses) {
    BodyDescription body;
    body.shape = shape;
    body.density = kDensity;
    body.X_WM = X;
    world.add_body(body);
  }
  return world;
}

Result run_gotai(const Options& o, const Pile& pile) {
  const ThreadLimit threads(o.threads);
  const ShapePointer shape = make_pile_shape(o, pile);
  Run run = run_once(o, pile, shape);
  for (int again = 1; again < o.repeat; ++again) {
    const Run other = run_once(o, pile, shape);
    if (other.world.state_hash() != run.world.state_hash())
      throw SimulationError("two runs of the same pile end in different states");
    for (std::size_t s = 0; s < run.steps.size(); ++s) run.steps[s].take_least(other.steps[s]);
  }
  const std::span<const StepTimes> all = run.steps;
  const std::span<const StepTimes> rest = all.subspan(run.at_rest);
  const StepTimes sum = sum_of(all);
  const StepTimes sum_rest = sum_of(rest);
  const auto per = [](double total, double count) { return total / std::max(1.0, count); };

  Result result;
  result.engine = "gotai";
  result.ms_per_step = per(sum.cpu, static_cast<double>(all.size()));
  result.ms_last_second = per(sum_rest.cpu, static_cast<double>(rest.size()));
  for (const StepTimes& step : all) result.ms_worst = std::max(result.ms_worst, step.cpu);
  result.contacts = per(sum.contacts, static_cast<double>(all.size()));
  result.us_per_contact = 1e3 * per(sum.cpu, sum.contacts);
  result.us_per_contact_last_second = 1e3 * per(sum_rest.cpu, sum_rest.contacts);
  const model::BodyState& bodies = run.world.bodies();
  result.rms_speed = rms_speed(bodies);
  result.energy_gain = run.energy_gain;
  for (model::BodyIndex i = 0; i < bodies.size(); ++i) {
    if (bodies.is_dynamic(i)) result.poses.push_back(bodies.mesh_pose(i));
  }
  fmt::print("wall-clock ms per step by phase, {} threads{}\n", o.threads,
             o.repeat > 1 ? fmt::format(", the least of {} runs of each step", o.repeat) : "");
  print_phases("run", all);
  print_phases("last second", rest);
  fmt::print("state hash {}\n", run.world.state_hash().hex());
  return result;
}

}  // namespace gotai::pile
