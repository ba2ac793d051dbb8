#include "gotai/world/run_summary.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "gotai/geometry/generate.h"
#include "gotai/world/world.h"

namespace gotai {
namespace {

std::shared_ptr<const voxel::Shape> cube() {
  return std::make_shared<voxel::Shape>(voxel::make_shape(
      "cube", geometry::generate({.shape = "cube"}), {.prepared_level = 3, .surface_level = 0}));
}

model::Settings level_3(double step) {
  model::Settings settings;
  settings.collision.model = model::CollisionModel::spheres;
  settings.collision.level = 3;
  settings.time.step = step;
  return settings;
}

BodyDescription cube_at(const Vec3& position) {
  BodyDescription body;
  body.X_WM.p = position;
  return body;
}

RunSummary run(World& world, double end) {
  RunMonitor monitor(world);
  while (!world.has_reached(end)) monitor.on_step(world, world.step());
  return monitor.summary(world, 1.5);
}

TEST(RunSummary, CountsStepsAndBodiesButNotTheFloor) {
  World world(level_3(0.01));
  world.add_shape(cube());
  world.add_plane({});
  world.add_body(cube_at({0, 0, 3}));
  const RunSummary summary = run(world, 0.1);
  EXPECT_EQ(summary.bodies, 1U);
  EXPECT_EQ(summary.steps, 10U);
  EXPECT_NEAR(summary.simulated_s, 0.1, 1e-12);
  EXPECT_EQ(summary.wall_s, 1.5);
  EXPECT_GE(summary.step_ms.max, summary.step_ms.p95);
  EXPECT_GE(summary.step_ms.max, summary.step_ms.mean);
  EXPECT_EQ(summary.state_hash, world.state_hash().hex());
}

TEST(RunSummary, FreeFallKeepsEnergyAndMomentumWhateverTheStep) {
  for (const double step : {0.01, 0.0}) {
    World world(level_3(step));
    world.add_shape(cube());
    BodyDescription body = cube_at({0, 0, 3});
    body.velocity = Vec3(1, 2, -3);
    body.angular_velocity = Vec3(0, 0, 2);
    world.add_body(body);
    const RunSummary summary = run(world, 1.0);
    EXPECT_GT(summary.energy.initial, 0.0);
    EXPECT_LT(summary.energy.max_gain, 1e-11 * summary.energy.initial) << step;
    EXPECT_LT(summary.momentum_error, 1e-12) << step;
    if (step > 0.0) {
      EXPECT_NEAR(summary.energy.final, summary.energy.initial, 1e-11 * summary.energy.initial);
    }
  }
}

TEST(RunSummary, AnImpulseFromNowhereIsAMomentumError) {
  World world(level_3(0.01));
  world.add_shape(cube());
  const BodyId body = world.add_body(cube_at({0, 0, 3}));
  RunMonitor monitor(world);
  world.apply_force(body, Vec3(100, 0, 0), Vec3(0, 0, 3));  // 1 N s on 1000 kg
  monitor.on_step(world, world.step());
  const RunSummary summary = monitor.summary(world, 0.0);
  EXPECT_NEAR(summary.momentum_error, 1.0 / (1000.0 * world.bodies().v_W[0].norm()), 1e-9);
}

TEST(RunSummary, EnergyFromNowhereIsAGain) {
  World world(level_3(0.01));
  world.add_shape(cube());
  const BodyId body = world.add_body(cube_at({0, 0, 3}));
  RunMonitor monitor(world);
  monitor.on_step(world, world.step());
  const double before = world.energy().total();
  world.apply_impulse(body, Vec3(1000, 0, 0), Vec3(0, 0, 3));
  monitor.on_step(world, world.step());
  const double gain = world.energy().total() - before;
  EXPECT_GT(gain, 499.0);
  EXPECT_NEAR(monitor.summary(world, 0.0).energy.max_gain, gain, 1e-9 * gain);
}

TEST(RunSummary, ABodyBehindAPlaneOrOutsideAContainerHasEscaped) {
  World world(level_3(0.01));
  world.add_shape(cube());
  PlaneDescription wall;
  wall.point = Vec3(-5, 0, 0);
  wall.normal = Vec3::UnitX();
  world.add_plane(wall);
  ContainerDescription container;
  container.inner = Vec3(4, 4, 2);
  world.add_container(container);
  for (const Vec3& inside : {Vec3(0, 0, 1), Vec3(3, 0, 2.5)}) world.add_body(cube_at(inside));
  for (const Vec3& outside : {Vec3(0, 0, -1), Vec3(3, 0, 1), Vec3(0, -3, 1), Vec3(-6, 0, 9)}) {
    world.add_body(cube_at(outside));
  }
  EXPECT_EQ(RunMonitor(world).summary(world, 0.0).escaped, 4U);
}

TEST(RunSummary, SaysHowFarTheTrueMeshesOverlap) {
  World world(level_3(0.01));
  world.add_shape(cube());
  world.add_plane({});
  const double d = std::sqrt(3.0);
  world.add_body(cube_at({0, 0, 0.49}));         // 0.01 in the floor
  world.add_body(cube_at({0.97, 0, 0.6}));       // 0.03 in the first, above the floor
  world.add_body(cube_at({0, 10, 0.5 + 1e-4}));  // touches the floor
  world.add_body(cube_at({0, 20, 3}));           // touches nothing
  const TrueOverlap v = measure_true_overlap(world.bodies(), world.shapes());
  EXPECT_EQ(v.touching, 3U);
  EXPECT_NEAR(v.max_m, 0.03, 1e-9);
  EXPECT_NEAR(v.max, 0.03 / d, 1e-9);
  EXPECT_NEAR(v.p99, 0.03 / d, 1e-9);
  EXPECT_NEAR(v.mean, 0.04 / d / 3.0, 1e-9);
}

TEST(RunSummary, SeesCrossedEdgesBetweenVertices) {
  // Two cubes turned by 45 degrees, about x and about y: only their edges cross, at their middles.
  World world(level_3(0.01));
  world.add_shape(cube());
  const double h = std::sqrt(0.5);
  BodyDescription below = cube_at({0, 0, 0});
  below.X_WM.q = Quat(Eigen::AngleAxisd(0.25 * std::numbers::pi, Vec3::UnitX()));
  BodyDescription above = cube_at({0, 0, 2.0 * h - 0.02});
  above.X_WM.q = Quat(Eigen::AngleAxisd(0.25 * std::numbers::pi, Vec3::UnitY()));
  world.add_body(below);
  world.add_body(above);
  const TrueOverlap v = measure_true_overlap(world.bodies(), world.shapes());
  EXPECT_EQ(v.touching, 1U);
  EXPECT_NEAR(v.max_m, 0.02 * h, 1e-5);  // the nearest way out is along a face's normal
}

TEST(RunSummary, MeasuresTheThirdNeighbour) {
  World world(level_3(0.01));
  world.add_shape(cube());
  world.add_body(cube_at({0, 0, 0}));
  world.add_body(cube_at({1.01, 0, 0}));
  world.add_body(cube_at({0, 1.02, 0}));
  world.add_body(cube_at({0, 0, 1.03}));
  const TrueOverlap v = measure_true_overlap(world.bodies(), world.shapes());
  EXPECT_EQ(v.touching, 0U);
  EXPECT_NEAR(v.gap3, std::hypot(0.02, 0.03) / std::sqrt(3.0), 1e-9);
}

TEST(RunSummary, StepMarginFollowsTheFastestBody) {
  World world(level_3(0.01));
  world.add_shape(cube());
  BodyDescription body = cube_at({0, 0, 3});
  body.velocity = Vec3(10, 0, 0);
  world.add_body(body);
  const RunSummary summary = run(world, 0.01);
  const double radius = world.bodies().voxel_radius[0];
  EXPECT_NEAR(summary.step_margin, radius / (10.0 * 0.01),
              0.03 * summary.step_margin);  // gravity counts, too
}

}  // namespace
}  // namespace gotai
