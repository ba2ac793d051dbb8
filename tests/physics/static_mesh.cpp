// Bodies on fixed meshes that are not convex, and in containers.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "support/worlds.h"

namespace gotai {
namespace {

constexpr int kMeshLevel = 6;

ShapeId add(World& world, const std::string& name) {
  return world.add_shape(test::surface_shape({.shape = name}, kMeshLevel));
}

World empty_world() { return test::surface_world(kMeshLevel, test::surface_material(0.0, 0.5)); }

// A ball that falls on a fixed ring sits in its hole, at the height that the two circles say.
TEST(StaticMesh, ABallRestsInTheHoleOfARing) {
  constexpr double kRing = 0.5 / 1.3;
  constexpr double kTube = 0.3 * kRing;
  World world = empty_world();
  BodyDescription ring;
  ring.shape = add(world, "torus");
  ring.kind = model::BodyKind::fixed;
  ring.X_WM.q = Quat(Eigen::AngleAxisd(0.3, Vec3::UnitZ()));
  world.add_body(ring);
  BodyDescription ball;
  ball.shape = add(world, "sphere");
  ball.X_WM.p = Vec3(0.02, -0.01, 0.6);
  ball.X_WM.q = Quat(Eigen::AngleAxisd(1.0, Vec3(1, 2, 3).normalized()));
  const BodyId id = world.add_body(ball);
  world.run_until(4.0);
  const Vec3 x = world.mesh_pose(id).p;
  EXPECT_NEAR(x.z(), std::sqrt(std::pow(0.5 + kTube, 2) - kRing * kRing), 2e-3);
  EXPECT_LT(std::hypot(x.x(), x.y()), 5e-3);
  EXPECT_LT(world.bodies().v_W[world.index(id)].norm(), 1e-3);
}

// A hexapod in a shaft, over a fixed hexapod: nothing goes through walls, floor or mesh.
TEST(StaticMesh, AHexapodFallsOnAFixedOneInsideAContainer) {
  World world = empty_world();
  const ShapeId shape = add(world, "hexapod");
  world.add_container({.name = "shaft", .inner = Vec3(3.0, 3.0, 9.0)});
  BodyDescription fixed;
  fixed.shape = shape;
  fixed.kind = model::BodyKind::fixed;
  fixed.X_WM.p = Vec3(0, 0, 1.2);
  world.add_body(fixed);
  BodyDescription falling;
  falling.shape = shape;
  falling.X_WM.p = Vec3(0.1, -0.05, 3.6);
  falling.X_WM.q = Quat(Eigen::AngleAxisd(0.4, Vec3(1, 1, 0.5).normalized()));
  const BodyId id = world.add_body(falling);
  double deepest = 0.0;
  while (world.time() < 5.0) {
    world.step();
    const Vec3 x = world.mesh_pose(id).p;
    ASSERT_LT(x.head<2>().cwiseAbs().maxCoeff(), 1.5) << world.time();
    ASSERT_GT(x.z(), 0.2) << "went through the floor at " << world.time();
    if (world.time() < 4.0) continue;
    for (const double gap : world.contacts().gap) deepest = std::min(deepest, gap);
  }
  EXPECT_GT(deepest, -5e-4);
  EXPECT_LT(world.bodies().v_W[world.index(id)].norm(), 1e-3);
}

}  // namespace
}  // namespace gotai
