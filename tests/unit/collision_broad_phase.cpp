#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "gotai/collision/broad_phase.h"
#include "gotai/core/parallel.h"
#include "gotai/core/random.h"
#include "support/voxel_shapes.h"

namespace gotai::collision {
namespace {

using model::BodyIndex;
using model::BodyState;
using model::Geometry;

struct Spheres {
  BodyState bodies;
  std::vector<double> radius;

  BodyIndex add(const Vec3& x, double r, bool dynamic = true) {
    const BodyIndex i = model::append_body(bodies);
    bodies.geometry[i] = Geometry::shape;
    bodies.x_W[i] = x;
    bodies.inverse_mass[i] = dynamic ? 1.0 : 0.0;
    radius.push_back(r);
    return i;
  }
  BodyIndex add_boundary(Geometry geometry, const Pose& pose, const Vec3& half_extent) {
    radius.push_back(0.0);
    return test::add_test_boundary(bodies, geometry, pose, half_extent);
  }
};

/// The definition, pair by pair.
std::vector<BodyPair> brute_force(const Spheres& scene, double margin) {
  std::vector<BodyPair> pairs;
  const BodyState& b = scene.bodies;
  for (BodyIndex i = 0; i < b.size(); ++i) {
    for (BodyIndex j = i + 1; j < b.size(); ++j) {
      if (!b.is_dynamic(i) && !b.is_dynamic(j)) continue;
      if ((b.x_W[i] - b.x_W[j]).norm() > scene.radius[i] + scene.radius[j] + margin) continue;
      pairs.push_back(b.is_dynamic(i) ? BodyPair{i, j} : BodyPair{j, i});
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const BodyPair& p, const BodyPair& q) {
    return std::pair(p.body_a, p.body_b) < std::pair(q.body_a, q.body_b);
  });
  return pairs;
}

std::vector<BodyPair> find_pairs(const Spheres& scene, double margin) {
  BroadPhase broad_phase;
  std::vector<BodyPair> pairs;
  broad_phase.find_pairs(scene.bodies, scene.radius, margin, pairs);
  return pairs;
}

TEST(BroadPhase, EmptyWorldAndOneBodyHaveNoPairs) {
  Spheres scene;
  EXPECT_TRUE(find_pairs(scene, 0.0).empty());
  scene.add(Vec3(1, 2, 3), 0.5);
  EXPECT_TRUE(find_pairs(scene, 1.0).empty());
}

class RandomScenes : public ::testing::TestWithParam<int> {};

TEST_P(RandomScenes, EqualBruteForce) {
  Random random(static_cast<std::uint64_t>(GetParam()));
  Spheres scene;
  // Equal sizes, mild mixes and mixes over several orders of magnitude; flat, long and cubic
  // worlds; far from the origin.
  const double spread = std::array{0.0, 0.5, 3.0}[static_cast<std::size_t>(GetParam()) % 3];
  const Vec3 extent(random.uniform(0.5, 6.0), random.uniform(0.5, 6.0), random.uniform(0.0, 3.0));
  const Vec3 center = random.uniform(0.0, 1e4) * random.unit_vector();
  const int count = 20 + GetParam() * 13;
  for (int i = 0; i < count; ++i) {
    const Vec3 x(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    scene.add(center + extent.cwiseProduct(x), 0.4 * std::pow(10.0, spread * random.uniform(-1, 0)),
              random.uniform() < 0.9);
  }
  for (const double margin : {0.0, 0.3}) {
    const std::vector<BodyPair> expected = brute_force(scene, margin);
    EXPECT_TRUE(!expected.empty() || count < 100 || spread > 1.0);
    EXPECT_EQ(find_pairs(scene, margin), expected);
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomScenes, ::testing::Range(1, 40));

// Enough bodies for rows of cells to be shared among threads; two classes of sizes.
TEST(BroadPhase, TheSamePairsForAnyNumberOfThreads) {
  Random random(61);
  Spheres scene;
  for (int i = 0; i < 900; ++i) {
    const Vec3 x(random.uniform(0.0, 6.0), random.uniform(0.0, 6.0), random.uniform(0.0, 6.0));
    scene.add(x, i % 3 == 0 ? 0.1 : 0.3, i % 7 != 0);
  }
  const std::vector<BodyPair> expected = brute_force(scene, 0.05);
  EXPECT_GT(expected.size(), 1000U);
  for (const int threads : {1, 2, 4}) {
    const ThreadLimit limit(threads);
    EXPECT_EQ(find_pairs(scene, 0.05), expected) << threads;
  }
}

TEST(BroadPhase, OneGiantAmongManySmallBodies) {
  Random random(7);
  Spheres scene;
  for (int i = 0; i < 300; ++i) {
    scene.add(Vec3(random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(-5, 5)), 0.2);
  }
  scene.add(Vec3(0, 0, -20), 18.0, false);
  scene.add(Vec3(0, 3, 0), 1e-4);
  EXPECT_EQ(find_pairs(scene, 0.01), brute_force(scene, 0.01));
}

TEST(BroadPhase, ABodyThatHasFlownAwayIsNoTrouble) {
  Random random(8);
  Spheres scene;
  for (int i = 0; i < 200; ++i) {
    scene.add(Vec3(random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3)), 0.4);
  }
  scene.add(Vec3(1e200, 0, 0), 0.4);
  scene.add(Vec3(0, -1e9, 1e12), 0.4);
  EXPECT_EQ(find_pairs(scene, 0.0), brute_force(scene, 0.0));
}

TEST(BroadPhase, SpheresThatTouchExactlyAreAPair) {
  Spheres scene;
  scene.add(Vec3(0, 0, 0), 0.5);
  scene.add(Vec3(1, 0, 0), 0.5);
  scene.add(Vec3(0, 1.0000001, 0), 0.5);
  EXPECT_EQ(find_pairs(scene, 0.0), (std::vector<BodyPair>{{0, 1}}));
}

TEST(BroadPhase, TheOnlyDynamicBodyIsBodyA) {
  Spheres scene;
  scene.add(Vec3(0, 0, 0), 0.5, false);
  scene.add(Vec3(0, 0, 0), 0.5, true);
  scene.add(Vec3(0, 0, 0), 0.5, true);
  scene.add(Vec3(0, 0, 0), 0.5, false);
  EXPECT_EQ(find_pairs(scene, 0.0),
            (std::vector<BodyPair>{{1, 0}, {1, 2}, {1, 3}, {2, 0}, {2, 3}}));
}

TEST(BroadPhase, PlanesMeetTheDynamicBodiesThatReachThem) {
  Spheres scene;
  scene.add_boundary(Geometry::plane, {}, Vec3::Zero());
  scene.add(Vec3(100, 0, 0.4), 0.5);
  scene.add(Vec3(0, 0, 0.6), 0.5);
  scene.add(Vec3(-9, 0, 0.4), 0.5, false);
  scene.add(Vec3(50, 70, -20), 0.5);
  EXPECT_EQ(find_pairs(scene, 0.0), (std::vector<BodyPair>{{1, 0}, {4, 0}}));
  EXPECT_EQ(find_pairs(scene, 0.1), (std::vector<BodyPair>{{1, 0}, {2, 0}, {4, 0}}));
}

TEST(BroadPhase, ATiltedPlane) {
  Spheres scene;
  const Pose tilt{Vec3(1, 0, 0), Quat(Eigen::AngleAxisd(1.0, Vec3::UnitY()))};
  scene.add_boundary(Geometry::plane, tilt, Vec3::Zero());
  const Vec3 normal = tilt.q * Vec3::UnitZ();
  scene.add(tilt.p + 0.45 * normal, 0.5);
  scene.add(tilt.p + 10 * (tilt.q * Vec3::UnitX()) + 0.55 * normal, 0.5);
  EXPECT_EQ(find_pairs(scene, 0.0), (std::vector<BodyPair>{{1, 0}}));
}

TEST(BroadPhase, ContainersMeetWhatReachesFloorOrWalls) {
  Spheres scene;
  scene.add_boundary(Geometry::container, {}, Vec3(2, 3, 4));
  scene.add(Vec3(0, 0, 2.0), 0.5);     // in the middle
  scene.add(Vec3(0, 0, 0.4), 0.5);     // on the floor
  scene.add(Vec3(1.6, 0, 2), 0.5);     // at +x
  scene.add(Vec3(0, -2.6, 2), 0.5);    // at -y
  scene.add(Vec3(-1.6, 0, 4.6), 0.5);  // over the rim
  EXPECT_EQ(find_pairs(scene, 0.0), (std::vector<BodyPair>{{2, 0}, {3, 0}, {4, 0}}));
}

TEST(BroadPhase, StorageIsReusedWithoutTraces) {
  BroadPhase broad_phase;
  std::vector<BodyPair> pairs;
  for (int seed = 0; seed < 6; ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    Spheres scene;
    const int count = seed % 2 == 0 ? 400 : 30;
    for (int i = 0; i < count; ++i) {
      scene.add(random.uniform(0.0, 4.0) * random.unit_vector(), random.uniform(0.01, 0.5));
    }
    broad_phase.find_pairs(scene.bodies, scene.radius, 0.0, pairs);
    EXPECT_EQ(pairs, brute_force(scene, 0.0));
  }
}

}  // namespace
}  // namespace gotai::collision
