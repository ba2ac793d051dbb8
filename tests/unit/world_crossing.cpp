// Contacts where edges of two bodies cross, away from every sample.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "gotai/collision/reduction.h"
#include "gotai/core/random.h"
#include "gotai/world/true_overlap.h"
#include "support/worlds.h"

namespace gotai {
namespace {

using test::ShapePointer;

constexpr double kThickness = 0.2;

ShapePointer bar(int level) {
  return test::surface_shape({.shape = "box", .extents = Vec3(1.0, kThickness, kThickness)}, level);
}

// Two bars with an edge up and an edge down that cross.
struct CrossedBars {
  World world;
  double cell;

  CrossedBars(int level, double gap, double twist, const Eigen::Vector2d& shift, const Quat& all,
              const Vec3& gravity)
      : world(test::surface_world(level, test::surface_material(0.0, 0.5), 1.0 / 60.0, gravity)) {
    const ShapePointer shape = bar(level);
    cell = static_cast<double>(shape->surface.field.cell);
    const Quat edge_up(Eigen::AngleAxisd(0.25 * std::numbers::pi, Vec3::UnitX()));
    BodyDescription body;
    body.shape = world.add_shape(shape);
    body.density = 1000.0;
    body.X_WM.q = all * edge_up;
    body.kind = model::BodyKind::fixed;
    world.add_body(body);
    body.kind = model::BodyKind::dynamic;
    body.X_WM.q = all * Quat(Eigen::AngleAxisd(twist, Vec3::UnitZ())) * edge_up;
    body.X_WM.p = all * Vec3(shift.x(), shift.y(), std::numbers::sqrt2 * kThickness + gap);
    world.add_body(body);
  }

  double deepest() const {
    const auto& gap = world.contacts().gap;
    return *std::ranges::min_element(gap);
  }
};

TEST(CrossedEdges, ContactsAreWhereTheLinesAreNearest) {
  Random random(4);
  for (const int level : {5, 6}) {
    double worst = 0.0;
    double worst_angle = 0.0;
    for (int trial = 0; trial < 24; ++trial) {
      const double twist = random.uniform(0.6, 2.5);
      const Eigen::Vector2d shift(random.uniform(-0.2, 0.2), random.uniform(-0.05, 0.05));
      const double gap = random.uniform(-2e-3, 1e-3);
      const Quat all = random.rotation();
      CrossedBars bars(level, gap, twist, shift, all, all * Vec3(0.0, 0.0, -9.81));
      bars.world.step();
      const model::ContactSet& contacts = bars.world.contacts();
      ASSERT_GT(contacts.size(), 0U) << twist << ' ' << shift.transpose();
      worst = std::max(worst, std::abs(bars.deepest() - gap) / bars.cell);
      const auto k =
          static_cast<std::size_t>(std::ranges::min_element(contacts.gap) - contacts.gap.begin());
      const double cosine = std::abs(contacts.normal_W[k].dot(all * Vec3::UnitZ()));
      worst_angle = std::max(worst_angle, std::acos(std::min(1.0, cosine)));
    }
    EXPECT_LT(worst, 0.05) << "cells at level " << level;
    EXPECT_LT(worst_angle, 0.01) << "level " << level;
  }
}

TEST(CrossedEdges, BarsOverlapByLessThanATwentiethOfACell) {
  for (const double twist : {0.5, 1.1, 1.5707963}) {
    CrossedBars bars(6, 1e-4, twist, {0.013, 0.007}, Quat::Identity(), Vec3(0.0, 0.0, -9.81));
    double worst = 0.0;
    for (int step = 0; step < 15; ++step) {
      bars.world.step();
      const TrueOverlap overlap = measure_true_overlap(bars.world.bodies(), bars.world.shapes());
      worst = std::max(worst, overlap.max_m / bars.cell);
    }
    EXPECT_LT(worst, 0.05) << twist;
    EXPECT_GT(bars.world.bodies().x_W[1].z(), std::numbers::sqrt2 * kThickness - 5e-3) << twist;
  }
}

// Near an edge the field is rounded: a corner that is in the body lies above it by the field.
TEST(CornersBesideEdges, AreContacts) {
  Random random(5);
  const ShapePointer shape = bar(5);
  const ShapePointer small =
      test::surface_shape({.shape = "box", .extents = Vec3::Constant(0.2)}, 5);
  const auto cell = static_cast<double>(shape->surface.field.cell);
  for (int trial = 0; trial < 40; ++trial) {
    const double depth = random.uniform(0.0, 0.02) * cell;
    const Vec3 normal = Vec3::UnitZ();
    // On the upper face of the bar, whose edge is along x.
    const Vec3 tip(random.uniform(-0.3, 0.3), 0.5 * kThickness - random.uniform(0.05, 0.4) * cell,
                   0.5 * kThickness - depth);
    const Quat corner_down = Quat::FromTwoVectors(Vec3(-1.0, -1.0, -1.0), -normal);
    const Quat turned = Quat(Eigen::AngleAxisd(random.uniform(0.0, 6.0), normal)) * corner_down;
    World world =
        test::surface_world(5, test::surface_material(0.0, 0.5), 1.0 / 60.0, Vec3::Zero());
    BodyDescription body;
    body.density = 1000.0;
    body.shape = world.add_shape(shape);
    body.kind = model::BodyKind::fixed;
    const Quat all = random.rotation();
    body.X_WM.q = all;
    world.add_body(body);
    body.shape = world.add_shape(small);
    body.kind = model::BodyKind::dynamic;
    body.X_WM.q = all * turned;
    body.X_WM.p = all * Vec3(tip - turned * Vec3::Constant(-0.1));
    world.add_body(body);
    world.step();
    const auto& gap = world.contacts().gap;
    ASSERT_FALSE(gap.empty()) << tip.transpose();
    EXPECT_NEAR(*std::ranges::min_element(gap), -depth, 1e-3 * cell) << tip.transpose();
  }
}

TEST(Twins, AndWhatIsFarAreDropped) {
  std::vector<collision::ContactCandidate> candidates(5);
  for (collision::ContactCandidate& c : candidates) {
    c.normal_A = Vec3::UnitZ();
    c.area = 1.0;
  }
  candidates[1].point_A = Vec3(0.1, 0.0, 0.0);
  candidates[2].point_A = Vec3(1e-5, 0.0, 0.0);
  candidates[2].area = 3.0;
  candidates[2].share_A = Vec3(0.4, 0.0, 0.0);
  candidates[3].normal_A = Vec3::UnitX();
  candidates[4].point_A = Vec3(0.0, 0.3, 0.0);
  candidates[4].gap = 0.6;
  collision::Reduction reduction;
  reduction.kept = {0, 1, 2, 3, 4};
  collision::drop_far_and_twins(candidates, 0.5, 1.0, reduction);
  EXPECT_THAT(reduction.kept, testing::ElementsAre(0, 1, 3));
  EXPECT_EQ(candidates[0].area, 4.0);
  EXPECT_NEAR(candidates[0].share_A.x(), 0.3, 1e-15);
}

}  // namespace
}  // namespace gotai
