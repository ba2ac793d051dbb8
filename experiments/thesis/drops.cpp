#include "thesis/drops.h"

#include <algorithm>
#include <cmath>

#include "gotai/core/parallel.h"
#include "gotai/core/random.h"

namespace gotai::experiments {
namespace {

void add_grid(World& world, ShapeId shape, int per_side, int layers, double spacing, double base,
              Random& random, bool turned) {
  for (int k = 0; k < layers; ++k)
    for (int j = 0; j < per_side; ++j)
      for (int i = 0; i < per_side; ++i) {
        const double half = 0.5 * (per_side - 1);
        const Vec3 x((i - half) * spacing + random.uniform(-0.02, 0.02),
                     (j - half) * spacing + random.uniform(-0.02, 0.02), base + k * spacing);
        add_unit_body(world, shape, x, turned ? random.rotation() : Quat::Identity());
      }
}

}  // namespace

void add_drop(World& world, const Drop& drop) {
  Random random(drop.seed);
  const ShapeId shape = world.add_shape(drop.shape);
  for (int i = 0; i < drop.count; ++i) {
    const double x = random.uniform(-0.15, 0.15) * drop.extent;
    const double y = random.uniform(-0.15, 0.15) * drop.extent;
    const Quat q = random.rotation();
    const Vec3 nudge = drop.perturbation * random.unit_vector();
    add_unit_body(world, shape, Vec3(x, y, (0.7 + 1.05 * i) * drop.extent) + nudge, q);
  }
}

Trajectory run_drop(const Setup& setup, const Drop& drop, double duration) {
  Json unused;
  return run_drop(setup, drop, duration, unused);
}

Trajectory run_drop(const Setup& setup, const Drop& drop, double duration, Json& record) {
  const ThreadLimit one_thread(1);
  World world = world_with_floor(setup);
  add_drop(world, drop);
  Totals totals(world);
  Trajectory trajectory = sample(world, duration);
  totals.write(record);
  return trajectory;
}

Trajectory sample(World& world, double duration) {
  Trajectory trajectory;
  const int samples = static_cast<int>(std::lround(50.0 * duration));
  for (int k = 1; k <= samples; ++k) {
    world.run_until(k / 50.0);
    std::vector<Vec3> row;
    for (model::BodyIndex i = 0; i < world.bodies().size(); ++i)
      if (world.bodies().is_dynamic(i)) row.push_back(world.bodies().x_W[i]);
    trajectory.push_back(row);
  }
  return trajectory;
}

double mean_error(const Trajectory& a, const Trajectory& b, double extent) {
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k)
    for (std::size_t i = 0; i < a[k].size(); ++i, ++count) sum += (a[k][i] - b[k][i]).norm();
  return count > 0 ? sum / (extent * static_cast<double>(count)) : 0.0;
}

void add_crowd(World& world, const std::string& scene, const Setup& setup, std::uint64_t seed) {
  Random random(seed);
  geometry::GeneratorOptions options;
  if (scene == "blocks") {
    options.shape = "cube";
    add_grid(world, world.add_shape(prepare(options, kFinestPrepared, setup)), 3, 3, 1.4, 0.8,
             random, false);
    options.shape = "hexapod";
    add_grid(world, world.add_shape(prepare(options, kFinestPrepared, setup)), 2, 2, 2.4, 6.0,
             random, true);
  } else {
    options.shape = "rock";
    add_grid(world, world.add_shape(prepare(options, kFinestPrepared, setup)), 4, 4, 1.45, 0.9,
             random, true);
  }
}

double step_of_level(int level) { return 1.0 / (50.0 * std::exp2(level - 3)); }

}  // namespace gotai::experiments
