// Balls of many triangles roll like balls, on planes and on meshes.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "support/worlds.h"

namespace gotai {
namespace {

constexpr double kGravity = 9.8;
constexpr double kRadius = 0.5;
constexpr int kRollingLevel = 6;

// Halved icosahedron: 20,480 triangles.
const test::ShapePointer& halved_icosahedron() {
  static const auto shape = test::surface_shape(
      {.shape = "rock", .size = 2 * kRadius, .subdivisions = 5, .roughness = 0.0}, kRollingLevel);
  return shape;
}

// A cube's mesh blown up: 20,172 triangles, of very different sizes.
const test::ShapePointer& blown_up_cube() {
  static const auto shape = test::surface_shape(
      {.shape = "sphere", .size = 2 * kRadius, .subdivisions = 41}, kRollingLevel);
  return shape;
}

enum class Ground { plane, mesh };

struct Rolling {
  World world;
  BodyId ball;
};

// A ball without rolling resistance on a ground that is tilted about y.
Rolling ball_on(Ground ground, double tilt, const test::ShapePointer& shape, double yaw,
                const Vec3& v, const Vec3& w) {
  model::Settings settings;
  settings.gravity = Vec3(0, 0, -kGravity);
  settings.collision.level = kRollingLevel;
  settings.time.step = 1.0 / 60.0;
  settings.impulse.rolling_resistance = 0.0;
  World world(settings);
  world.set_default_material(test::surface_material(0.0, 0.5));
  const Quat q(Eigen::AngleAxisd(tilt, Vec3::UnitY()));
  if (ground == Ground::plane) {
    PlaneDescription plane;
    plane.normal = q * Vec3::UnitZ();
    world.add_plane(plane);
  } else {
    BodyDescription slab;
    slab.shape = world.add_shape(
        test::surface_shape({.shape = "box", .extents = Vec3(14, 3, 1)}, kRollingLevel));
    slab.kind = model::BodyKind::fixed;
    slab.com_position = q * Vec3(0, 0, -0.5);
    slab.X_WM.q = q;
    world.add_body(slab);
  }
  BodyDescription body;
  body.shape = world.add_shape(shape);
  body.com_position = q * Vec3(-3, 0, kRadius);
  body.X_WM.q = Quat(Eigen::AngleAxisd(yaw, Vec3(0.3, 0.2, 1.0).normalized()));
  body.velocity = v;
  body.angular_velocity = w;
  const BodyId ball = world.add_body(body);
  return {std::move(world), ball};
}

class SurfaceRolling : public testing::TestWithParam<Ground> {};

TEST_P(SurfaceRolling, ABallKeepsRolling) {
  for (const auto& shape : {halved_icosahedron(), blown_up_cube()}) {
    for (const double yaw : {0.0, 0.7}) {
      Rolling r = ball_on(GetParam(), 0.0, shape, yaw, Vec3(1, 0, 0), Vec3(0, 1 / kRadius, 0));
      r.world.run_until(5.0);
      const Vec3 v = r.world.bodies().v_W[r.world.index(r.ball)];
      std::printf("%s: rolls at %.4f m/s after 5 s\n", shape->name.c_str(), v.x());
      EXPECT_GE(v.x(), 0.99);
      EXPECT_LE(v.x(), 1.001);
      EXPECT_LE(std::abs(v.y()), 0.01);
    }
  }
}

TEST_P(SurfaceRolling, ABallRollsDownAsItShould) {
  const double tilt = 10.0 * M_PI / 180.0;
  for (const auto& shape : {halved_icosahedron(), blown_up_cube()}) {
    for (const double yaw : {0.0, 0.7}) {
      Rolling r = ball_on(GetParam(), tilt, shape, yaw, Vec3::Zero(), Vec3::Zero());
      r.world.run_until(1.0);
      const Vec3 v = r.world.bodies().v_W[r.world.index(r.ball)];
      const double exact = 5.0 / 7.0 * kGravity * std::sin(tilt) * r.world.time();
      const double along = v.dot(Vec3(std::cos(tilt), 0, -std::sin(tilt)));
      std::printf("%s: %.4f of 5/7 g sin\n", shape->name.c_str(), along / exact);
      EXPECT_NEAR(along, exact, 2e-3 * exact);
      EXPECT_LE(std::abs(v.y()), 2e-3 * exact);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Grounds, SurfaceRolling, testing::Values(Ground::plane, Ground::mesh),
                         [](const auto& ground) {
                           return ground.param == Ground::plane ? "plane" : "mesh";
                         });

}  // namespace
}  // namespace gotai
