// The penalty method's settings against closed forms of its springs.
#include <gtest/gtest.h>

#include <numbers>

#include "support/worlds.h"

namespace gotai {
namespace {

model::Settings penalty_settings(int level, double dt) {
  model::Settings settings = test::thesis_settings(level, dt);
  settings.impulse.method = model::ImpulseMethodName::penalty;
  return settings;
}

// Overlap of a cube of 1 kg at rest, e = 0.
struct Rest {
  double depth = 0.0;    // [m]
  double substep = 0.0;  // [s]
};

Rest come_to_rest(const model::Settings& settings) {
  test::CubeWorld scene(settings, 0.0, 0.5, 0.0);
  scene.world.run_until(5.0);
  const double contact_height = 0.5 + test::CubeWorld::sphere_offset(settings.collision.level);
  return {contact_height - scene.position().z(),
          settings.time.step / scene.world.step().solve.substeps};
}

TEST(Penalty, ABodyAtRestSinksAsDeepAsAllowed) {
  model::Settings settings = penalty_settings(3, 0.05);
  const double radius =
      test::CubeWorld(settings, 0.0, 0.5, 0.0).world.bodies().bounding_radius.front();
  // The critical damper sees the speed g h of the sub-step's gravity and carries 2 w h of the
  // weight; the spring the rest, so that the depth is (1 - 2 w h) g / w^2.
  const auto expect_depth = [&](double frequency) {
    const Rest rest = come_to_rest(settings);
    const double depth = 9.8 / std::pow(frequency, 2);
    EXPECT_NEAR(rest.depth, depth * (1.0 - 2.0 * frequency * rest.substep), 1e-6 * depth);
    EXPECT_LE(rest.depth, depth);
  };
  for (const double penetration : {1e-3, 1e-4}) {
    settings.impulse.penetration = penetration;
    expect_depth(std::sqrt(9.8 / (penetration * radius)));
  }
  // A larger allowance leaves the stiffness with which a collision lasts one step.
  settings.impulse.penetration = 0.1;
  expect_depth(std::numbers::pi / settings.time.step);
}

TEST(Penalty, AStifferSpringTakesMoreSubSteps) {
  model::Settings settings = penalty_settings(3, 0.05);
  std::uint32_t last = 0;
  for (const double penetration : {1e-3, 1e-4, 1e-5}) {
    settings.impulse.penetration = penetration;
    test::CubeWorld scene(settings, 0.0, 0.5, 0.0);
    const std::uint32_t substeps = scene.world.step().solve.substeps;
    EXPECT_GT(substeps, 2 * last) << "sqrt(10) times as many";
    last = substeps;
  }
}

TEST(Penalty, TensionGivesTheRestitutionAskedForAndWithoutItMore) {
  // A ball of one voxel sphere, no gravity (erratum 2: 0.1 becomes 0.25 when forces only push).
  for (const auto& [tension, expected] : {std::pair{true, 0.1}, {false, 0.253}}) {
    model::Settings settings = penalty_settings(1, 0.01);
    settings.gravity.setZero();
    settings.impulse.tension = tension;
    test::CubeWorld scene(settings, 0.1, 0.0, 1e-3, -Vec3::UnitZ());
    scene.world.run_until(0.1);
    EXPECT_NEAR(scene.velocity().z(), expected, 0.03) << tension;
  }
}

}  // namespace
}  // namespace gotai
