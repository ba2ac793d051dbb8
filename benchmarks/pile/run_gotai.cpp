#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

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

// Sums over steps, wall clock [ms].
struct Phases {
  double collision = 0.0, impulse = 0.0, integration = 0.0, other = 0.0, contacts = 0.0,
         tests = 0.0;
  int steps = 0;

  void add(const model::StepReport& r) {
    collision += 1e3 * r.collision_s;
    impulse += 1e3 * r.impulse_s;
    integration += 1e3 * r.integration_s;
    other += 1e3 * r.other_s;
    contacts += r.contacts;
    tests += static_cast<double>(r.tests);
    ++steps;
  }
  void print(const char* name) const {
    const double n = std::max(1, steps);
    fmt::print(
        "{:<12} collision {:7.3f}  impulse {:7.3f}  integration {:7.3f}  other {:7.3f}  "
        "contacts {:6.0f}  tests {:8.0f}\n",
        name, collision / n, impulse / n, integration / n, other / n, contacts / n, tests / n);
  }
};

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
  World world = make_world(o, pile, make_pile_shape(o, pile));
  Result result;
  result.engine = "gotai";
  const double initial = world.energy().total();
  double highest = initial;
  Phases all, rest;
  double cpu_sum = 0.0, cpu_rest = 0.0;
  while (!world.has_reached(o.seconds)) {
    const double start = cpu_seconds();
    const model::StepReport report = world.step();
    const double ms = 1e3 * (cpu_seconds() - start);
    all.add(report);
    cpu_sum += ms;
    result.ms_worst = std::max(result.ms_worst, ms);
    if (world.time() > o.seconds - 1.0) {
      rest.add(report);
      cpu_rest += ms;
    }
    highest = std::max(highest, report.energy.total());
    if (o.verbose && world.step_count() % 30 == 0) {
      fmt::print("  t {:5.2f} s  {:7.2f} ms  contacts {:6}  overlap {:.1e} m  rms speed {:.1e}\n",
                 world.time(), ms, report.contacts, report.max_overlap, rms_speed(world.bodies()));
      std::fflush(stdout);
    }
  }
  result.ms_per_step = cpu_sum / std::max(1, all.steps);
  result.ms_last_second = cpu_rest / std::max(1, rest.steps);
  result.contacts = all.contacts / std::max(1, all.steps);
  result.us_per_contact = 1e3 * cpu_sum / std::max(1.0, all.contacts);
  result.us_per_contact_last_second = 1e3 * cpu_rest / std::max(1.0, rest.contacts);
  result.rms_speed = rms_speed(world.bodies());
  result.energy_gain = (highest - initial) / std::abs(initial);
  for (model::BodyIndex i = 0; i < world.bodies().size(); ++i) {
    if (world.bodies().is_dynamic(i)) result.poses.push_back(world.bodies().mesh_pose(i));
  }
  fmt::print("wall-clock ms per step by phase, {} threads\n", o.threads);
  all.print("run");
  rest.print("last second");
  fmt::print("state hash {}\n", world.state_hash().hex());
  return result;
}

}  // namespace gotai::pile
