// Piles with contacts from the surfaces, reduced, and the sub-stepped solver: deep overlaps part
// gently.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "gotai/core/random.h"
#include "support/worlds.h"

namespace gotai {
namespace {

constexpr int kPileLevel = 6;

World world_with(const Vec3& gravity) {
  return test::surface_world(kPileLevel, test::surface_material(0.2, 0.5), 1.0 / 60.0, gravity);
}

class DeepOverlap : public testing::TestWithParam<const char*> {};

// Eight bodies in a block, each a tenth of its size in its neighbours. They float, so that all the
// energy there is comes from parting; the pile's energy is what lifting it by its own height takes.
TEST_P(DeepOverlap, PartsWithoutABang) {
  World world = world_with(Vec3::Zero());
  const auto shape = test::surface_shape({.shape = GetParam()}, kPileLevel);
  const ShapeId id = world.add_shape(shape);
  const Box3 box = geometry::bounding_box(shape->mesh);
  const double size = box.sizes().maxCoeff();
  for (int k = 0; k < 8; ++k) {
    BodyDescription body;
    body.shape = id;
    body.X_WM.p = 0.9 * Vec3(k & 1, (k >> 1) & 1, k >> 2).cwiseProduct(box.sizes());
    world.add_body(body);
  }
  double mass = 0.0;
  for (model::BodyIndex i = 0; i < 8; ++i) mass += 1.0 / world.bodies().inverse_mass[i];
  double most = 0.0;
  double overlap = 0.0;
  for (int k = 0; k < 120; ++k) {
    const model::StepReport report = world.step();
    most = std::max(most, report.energy.total());
    if (k == 0) {
      EXPECT_GT(report.max_overlap, 0.02 * size);
    }
    overlap = report.max_overlap;
  }
  EXPECT_LT(most, 0.01 * mass * 9.81 * size);
  EXPECT_LT(overlap, 2e-3 * size);
}

INSTANTIATE_TEST_SUITE_P(Shapes, DeepOverlap,
                         testing::Values("cube", "sphere", "hexapod", "torus", "rock"),
                         [](const auto& shape) { return std::string(shape.param); });

// How often one ring passes through another, with signs: the centre line of the second through the
// disc of the first.
int linking_number(const Pose& first, const Pose& second, double radius) {
  constexpr int kSteps = 360;
  const auto at = [&](int k) {
    const double angle = 2.0 * M_PI * k / kSteps;
    return Vec3(first.inverse() *
                (second * Vec3(radius * std::cos(angle), radius * std::sin(angle), 0)));
  };
  int number = 0;
  for (int k = 0; k < kSteps; ++k) {
    const Vec3 from = at(k);
    const Vec3 to = at(k + 1);
    if ((from.z() < 0.0) == (to.z() < 0.0)) continue;
    const Vec3 crossing = from + from.z() / (from.z() - to.z()) * (to - from);
    if (crossing.norm() < radius) number += to.z() < 0.0 ? -1 : 1;
  }
  return number;
}

TEST(Chain, TenLinksHangForHalfAMinute) {
  constexpr int kLinks = 11;  // the first is fixed
  constexpr double kRing = 0.5 / 1.3;
  constexpr double kTube = 0.3 * kRing;
  World world = world_with(Vec3(0, 0, -9.81));
  const ShapeId id = world.add_shape(test::surface_shape({.shape = "torus"}, kPileLevel));
  for (int k = 0; k < kLinks; ++k) {
    BodyDescription link;
    link.shape = id;
    link.kind = k == 0 ? model::BodyKind::fixed : model::BodyKind::dynamic;
    link.X_WM.p = Vec3(0, 0, -1.96 * (kRing - kTube) * k);
    link.X_WM.q = Quat(Eigen::AngleAxisd(0.5 * M_PI, k % 2 == 0 ? Vec3::UnitX() : Vec3::UnitY()));
    if (k == kLinks - 1) link.velocity = Vec3(1.0, 0.5, 0.0);
    world.add_body(link);
  }
  const auto numbers = [&] {
    std::vector<int> all;
    for (int i = 0; i < kLinks; ++i) {
      for (int j = i + 1; j < kLinks; ++j) {
        all.push_back(linking_number(world.mesh_pose(world.id(static_cast<model::BodyIndex>(i))),
                                     world.mesh_pose(world.id(static_cast<model::BodyIndex>(j))),
                                     kRing));
      }
    }
    return all;
  };
  const std::vector<int> start = numbers();
  EXPECT_EQ(std::ranges::count_if(start, [](int n) { return n != 0; }), kLinks - 1);
  while (world.time() < 30.0) {
    for (int k = 0; k < 60; ++k) world.step();
    ASSERT_EQ(numbers(), start) << world.time();
  }
}

// Rings that meet at up to 20 m/s and turn at 25 rad/s cross more than a tube within a step: what
// they will meet then must be found before.
TEST(FastRings, DoNotPassThroughEachOther) {
  constexpr int kPairs = 200;
  constexpr double kRing = 0.5 / 1.3;
  World world = world_with(Vec3::Zero());
  const ShapeId id = world.add_shape(test::surface_shape({.shape = "torus"}, kPileLevel));
  Random random(5);
  for (int k = 0; k < kPairs; ++k) {
    const Vec3 from = random.unit_vector();
    for (const double side : {-1.0, 1.0}) {
      BodyDescription ring;
      ring.shape = id;
      ring.X_WM.p = Vec3(10.0 * k, 0, 0) + 0.6 * side * from + 0.1 * random.unit_vector();
      ring.X_WM.q = random.rotation();
      ring.velocity = -10.0 * side * from;
      ring.angular_velocity = 25.0 * random.unit_vector();
      world.add_body(ring);
    }
  }
  for (int k = 0; k < 12; ++k) world.step();
  for (model::BodyIndex i = 0; i < 2 * kPairs; i += 2) {
    EXPECT_EQ(linking_number(world.mesh_pose(world.id(i)), world.mesh_pose(world.id(i + 1)), kRing),
              0)
        << i;
  }
}

}  // namespace
}  // namespace gotai
