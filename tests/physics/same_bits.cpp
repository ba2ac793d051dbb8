// A pile of all kinds of bodies ends in the same state however it was computed.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "gotai/core/parallel.h"
#include "gotai/core/random.h"
#include "support/worlds.h"

namespace gotai {
namespace {

constexpr int kBitsLevel = 5;

// Shapes are made once: they are the same for all worlds.
const std::vector<test::ShapePointer>& shapes() {
  static const std::vector<test::ShapePointer> all = {
      test::surface_shape({.shape = "hexapod"}, kBitsLevel),
      test::surface_shape({.shape = "torus"}, kBitsLevel),
      test::surface_shape({.shape = "rock"}, kBitsLevel),
      test::surface_shape({.shape = "cube"}, kBitsLevel)};
  return all;
}

// Sixteen bodies over an open box.
World small_pile() {
  World world = test::surface_world(kBitsLevel, test::surface_material(0.2, 0.5));
  for (const auto& shape : shapes()) world.add_shape(shape);
  world.add_container({.name = "container", .inner = Vec3(3.6, 3.6, 8.0)});
  Random random(11);
  for (int k = 0; k < 16; ++k) {
    const int layer = k / 4;
    BodyDescription body;
    body.shape = static_cast<ShapeId>((k + layer) % 4);
    body.X_WM.p = Vec3((k & 1) - 0.5, ((k >> 1) & 1) - 0.5, layer + 0.6) * 1.75;
    body.X_WM.q = random.rotation();
    world.add_body(body);
  }
  return world;
}

struct Outcome {
  Hash128 hash;
  std::size_t anchored = 0;         // pairs whose contacts outlived a step, summed over steps
  std::uint64_t tests_falling = 0;  // in the second second, when bodies meet, and in the last
  std::uint64_t tests_at_end = 0;
};

// @param afresh  every step is taken by a world that knows the state and nothing else
Outcome simulate(int steps, bool afresh) {
  Outcome result;
  World world = small_pile();
  for (int k = 0; k < steps; ++k) {
    const Snapshot before = world.snapshot();
    if (afresh) {
      world = small_pile();
      world.restore(before);
    }
    const model::StepReport report = world.step();
    if (k >= 60 && k < 120) result.tests_falling += report.tests;
    if (k >= steps - 60) result.tests_at_end += report.tests;
    std::size_t p = 0;
    for (const model::ContactAnchors::Pair& now : world.snapshot().anchors.pairs) {
      const auto& old = before.anchors.pairs;
      while (p < old.size() &&
             std::pair(old[p].body_a, old[p].body_b) < std::pair(now.body_a, now.body_b)) {
        ++p;
      }
      if (p < old.size() && old[p].X_BA.p == now.X_BA.p) ++result.anchored;
    }
  }
  result.hash = world.state_hash();
  return result;
}

TEST(SameBits, ForOneAndTwoThreadsTwiceAndWithoutWhatSearchesRemember) {
  constexpr int kSteps = 540;
  const Outcome first = [] {
    const ThreadLimit one(1);
    return simulate(kSteps, false);
  }();
  EXPECT_GT(first.anchored, 1000U);
  EXPECT_LT(10 * first.tests_at_end, first.tests_falling);
  const ThreadLimit two(2);
  EXPECT_EQ(simulate(kSteps, false).hash, first.hash);
  EXPECT_EQ(simulate(kSteps, true).hash, first.hash);
}

// Bodies that are moved or hit do not keep the contacts of where they were.
TEST(SameBits, AnchorsEndWithAPushAndAMove) {
  World world = small_pile();
  for (int k = 0; k < 520; ++k) world.step();
  const auto anchor_of = [&](model::BodyIndex body) {
    const Snapshot now = world.snapshot();
    const auto found = std::ranges::find_if(now.anchors.pairs,
                                            [&](const auto& pair) { return pair.body_a == body; });
    return found == now.anchors.pairs.end() ? Vec3(Vec3::Zero()) : found->X_BA.p;
  };
  const model::BodyIndex body = 4;
  const Vec3 resting = anchor_of(body);
  world.step();
  EXPECT_EQ(anchor_of(body), resting);
  world.set_velocity(world.id(body), Vec3(0, 0, 0.1), Vec3::Zero());
  world.step();
  EXPECT_NE(anchor_of(body), resting);
  world.set_mesh_pose(world.id(body), {Vec3(0, 0, 5), Quat::Identity()});
  world.step();
  EXPECT_EQ(anchor_of(body), Vec3(Vec3::Zero()));
}

}  // namespace
}  // namespace gotai
