#include "gotai/world/run_summary.h"

#include <gtest/gtest.h>

#include "gotai/geometry/generate.h"
#include "gotai/world/world.h"

namespace gotai {
namespace {

std::shared_ptr<const voxel::Shape> cube() {
  return std::make_shared<voxel::Shape>(
      voxel::make_shape("cube", geometry::generate({.shape = "cube"}), {.prepared_level = 3}));
}

model::Settings level_3(double step) {
  model::Settings settings;
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

}  // namespace
}  // namespace gotai
