// The sub-stepped solver on voxel-sphere contacts: rest, sliding, bouncing, stacks, bits.
#include <gtest/gtest.h>

#include <hwy/targets.h>

#include <cmath>
#include <cstdio>

#include "gotai/core/parallel.h"
#include "support/worlds.h"

namespace gotai {
namespace {

constexpr int kLevel = 4;

test::ShapePointer shape_of(const char* name) { return test::make_generated(name, kLevel); }

/// Height of a flat cube's centre when its voxel spheres touch the floor.
double touching_height() {
  const auto cube = shape_of("cube");
  return 0.5 - 0.5 * cube->pyramid.grid.voxel_edge(kLevel) +
         cube->pyramid.grid.voxel_radius(kLevel);
}

World floor_world(double restitution, double friction, double dt) {
  model::Settings settings = test::thesis_settings(kLevel, dt);
  settings.impulse.solver = model::SolverName::substepped;
  World world(settings);
  world.set_default_material(test::surface_material(restitution, friction));
  world.add_plane({});
  return world;
}

BodyId add_cube(World& world, ShapeId shape, const Vec3& x, const Vec3& v = Vec3::Zero(),
                const Vec3& w = Vec3::Zero()) {
  BodyDescription body;
  body.shape = shape;
  body.mass = 1.0;
  body.com_position = x;
  body.velocity = v;
  body.angular_velocity = w;
  return world.add_body(body);
}

TEST(Substepped, ACubeAtRestStays) {
  World world = floor_world(0.3, 0.5, 1.0 / 60.0);
  const double z0 = touching_height();
  add_cube(world, world.add_shape(shape_of("cube")), Vec3(0, 0, z0));
  world.run_until(1.0);
  const Vec3 settled = world.bodies().x_W[1];
  EXPECT_NEAR(settled.z(), z0, 1e-4);
  world.run_until(6.0);
  EXPECT_LT((world.bodies().x_W[1] - settled).norm(), 1e-6);
  EXPECT_LT(world.bodies().v_W[1].norm(), 1e-6);
}

TEST(Substepped, ASlidingBlockStopsWhereCoulombSays) {
  World world = floor_world(0.0, 0.3, 1.0 / 200.0);
  add_cube(world, world.add_shape(shape_of("cube")), Vec3(0, 0, touching_height()), Vec3(2, 0, 0));
  world.run_until(2.0);
  EXPECT_NEAR(world.bodies().x_W[1].x(), 4.0 / (2.0 * 0.3 * 9.8), 0.01 * 4.0 / (2.0 * 0.3 * 9.8));
  EXPECT_LT(std::abs(world.bodies().x_W[1].y()), 1e-3);
  EXPECT_LT(world.bodies().v_W[1].norm(), 1e-6);
}

TEST(Substepped, ASpinningCubeStopsAsUnderUniformPressure) {
  World world = floor_world(0.0, 0.3, 1.0 / 200.0);
  add_cube(world, world.add_shape(shape_of("cube")), Vec3(0, 0, touching_height()), Vec3::Zero(),
           Vec3(0, 0, 10));
  double stop = 0.0;
  while (world.bodies().w_W[1].z() > 1e-3 && world.time() < 3.0) {
    world.step();
    stop = world.time();
  }
  EXPECT_NEAR(stop, 1.4901, 0.05 * 1.4901);
  EXPECT_LT(world.bodies().x_W[1].head<2>().norm(), 5e-3);
}

TEST(Substepped, RestitutionReturnsTheSpeed) {
  World world = floor_world(0.5, 0.0, 1.0 / 200.0);
  add_cube(world, world.add_shape(shape_of("cube")), Vec3(0, 0, touching_height() + 1e-6),
           Vec3(0, 0, -3));
  world.step();
  EXPECT_NEAR(world.bodies().v_W[1].z(), 1.5, 0.03);
}

/// Velocity after the first impact of a cube, prepared with its surface, on the floor.
Vec3 bounce_on_surface(const Vec3& v, double friction) {
  World world =
      test::surface_world(kLevel, test::surface_material(0.3, friction), 1e-3, Vec3(0, 0, -9.8));
  world.add_plane({});
  add_cube(world, world.add_shape(test::surface_shape({.shape = "cube"}, kLevel)), Vec3(0, 0, 0.8),
           v);
  while (world.time() < 1.0 && world.bodies().v_W[1].z() <= 0.0) world.step();
  return world.bodies().v_W[1];
}

TEST(Substepped, ABoxThatLandsFlatDoesNotLeaveSideways) {
  const Vec3 v = bounce_on_surface(Vec3::Zero(), 0.3);
  EXPECT_NEAR(v.z(), 0.3 * 2.42, 0.01);
  EXPECT_LT(v.head<2>().norm(), 0.005 * 2.42);  // 4 % when the bounce has no friction
}

TEST(Substepped, FrictionSlowsASlidingBoxByTheWholeImpulseOfTheBounce) {
  const double v_in = std::sqrt(2.0 * 9.8 * 0.3);
  const double slowed = 8.0 - bounce_on_surface(Vec3(8, 0, 0), 0.1).x();
  EXPECT_NEAR(slowed, 0.1 * 1.3 * v_in, 0.03 * 0.1 * 1.3 * v_in);
}

TEST(Substepped, AStackStandsAndEnergyOnlyFalls) {
  World world = floor_world(0.0, 0.5, 1.0 / 60.0);
  const ShapeId shape = world.add_shape(shape_of("cube"));
  const double touch = touching_height();
  for (int k = 0; k < 4; ++k)
    add_cube(world, shape, Vec3(0, 0, touch + 2.0 * touch * k + 1e-3 * k));
  double lowest = 1e30;
  double gain = 0.0;
  world.add_observer([&](const World& w, const model::StepReport&) {
    const double energy = w.energy().kinetic + w.energy().potential;
    gain = std::max(gain, energy - lowest);
    lowest = std::min(lowest, energy);
  });
  world.run_until(5.0);
  EXPECT_LT(gain, 1e-3 * lowest);
  EXPECT_GT(world.bodies().q_WB[4].w(), 0.999);
  EXPECT_LT(world.bodies().v_W[4].norm(), 0.1);  // sphere normals are bumpy: it never quite rests
}

TEST(Substepped, FreeFallKeepsTheEnergyOfItsSubSteps) {
  World world = floor_world(0.2, 0.5, 1.0 / 60.0);
  add_cube(world, world.add_shape(shape_of("cube")), Vec3(0, 0, 20), Vec3(1, 0, 2), Vec3(1, 2, 3));
  const double initial = world.step().energy.total();
  double largest = 0.0;
  for (int k = 0; k < 60; ++k) {
    const model::StepReport report = world.step();
    largest = std::max(largest, std::abs(report.energy.total() - initial));
    EXPECT_EQ(report.energy.total(), world.energy().total());
  }
  EXPECT_LT(largest, 1e-10 * initial);
}

TEST(Substepped, SameBitsForOneAndTwoThreadsAndTwice) {
  const auto run = [](int threads) {
    const ThreadLimit limit(threads);
    World world = floor_world(0.2, 0.5, 1.0 / 60.0);
    const ShapeId shape = world.add_shape(shape_of("hexapod"));
    for (int k = 0; k < 5; ++k) add_cube(world, shape, Vec3(0.2 * k, 0.1 * k, 1.5 + 2.3 * k));
    world.run_until(2.0);
    return world.state_hash();
  };
  const Hash128 one = run(1);
  EXPECT_EQ(one, run(2));
  EXPECT_EQ(one, run(1));
}

// Many pairs in every wave of the solver, so that threads do share the work.
TEST(Substepped, APileOnItsSurfacesHasTheSameBitsForAnyThreadsAndInstructionSet) {
  const auto shape = test::surface_shape({.shape = "hexapod"}, kLevel);
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    World world = test::surface_world(kLevel, {});
    world.add_plane({});
    const ShapeId id = world.add_shape(shape);
    for (int k = 0; k < 300; ++k) {
      const int layer = k / 100;
      BodyDescription body;
      body.shape = id;
      body.X_WM.p = 2.3 * Vec3(k % 10, (k / 10) % 10, 0.5 + layer);
      body.angular_velocity = Vec3(0.1 * (k % 7), 0.2, 0.3 * (k % 3));
      world.add_body(body);
    }
    world.run_until(1.2);
    EXPECT_GT(world.contacts().pairs.size(), 150U);
    return world.state_hash();
  };
  const Hash128 one = run(1);
  EXPECT_EQ(one, run(2));
  for (const std::int64_t targets : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(targets);
    hwy::GetChosenTarget().Update(targets);
    EXPECT_EQ(one, run(1)) << hwy::TargetName(targets);
    std::printf("same bits with %s\n", hwy::TargetName(targets));
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace
}  // namespace gotai
