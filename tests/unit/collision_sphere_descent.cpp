#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "gotai/collision/sphere_descent.h"
#include "gotai/core/error.h"
#include "gotai/core/random.h"
#include "support/voxel_shapes.h"

namespace gotai::collision {
namespace {

using VoxelPair = DescentTrace::VoxelPair;

std::vector<VoxelPair> voxel_pairs(const std::vector<SphereOverlap>& overlaps) {
  std::vector<VoxelPair> pairs;
  pairs.reserve(overlaps.size());
  for (const SphereOverlap& o : overlaps) pairs.push_back({o.a, o.b});
  return pairs;
}

/// Every sphere of level k against every other.
std::vector<VoxelPair> brute_force(const voxel::Pyramid& a, const voxel::Pyramid& b,
                                   const Pose& X_BA, int level, double margin) {
  std::vector<VoxelPair> pairs;
  const Mat3 R_BA = X_BA.q.toRotationMatrix();
  const double touching = a.grid.voxel_radius(level) + b.grid.voxel_radius(level);
  for (std::uint32_t i = 0; i < a.level(level).size(); ++i) {
    const Vec3 c_A = R_BA * a.voxel_center(level, i) + X_BA.p;
    for (std::uint32_t j = 0; j < b.level(level).size(); ++j) {
      if ((c_A - b.voxel_center(level, j)).norm() - touching <= margin) pairs.push_back({i, j});
    }
  }
  return pairs;
}

struct Descent {
  std::vector<SphereOverlap> overlaps;
  TestCounts tests{};

  Descent(const voxel::Pyramid& a, const voxel::Pyramid& b, const Pose& X_BA, int level,
          double margin) {
    const SphereTree tree_a = make_sphere_tree(a);
    const SphereTree tree_b = make_sphere_tree(b);
    DescentScratch scratch;
    descend(tree_a, tree_b, X_BA, level, margin, scratch, overlaps, tests);
  }
};

TEST(SphereTree, LinksEveryChildOnce) {
  const auto shape = test::six_legs(5);
  const SphereTree tree = make_sphere_tree(shape->pyramid);
  ASSERT_EQ(tree.levels.size(), 4U);
  for (std::size_t h = 1; h < 5; ++h) {
    const voxel::PyramidLevel& parents = shape->pyramid.levels[h - 1];
    const voxel::PyramidLevel& children = shape->pyramid.levels[h];
    std::size_t next = 0;
    for (std::size_t i = 0; i < parents.size(); ++i) {
      EXPECT_EQ(tree.levels[h - 1][i].first_child, next);
      for (std::uint32_t octant = 0; octant < 8; ++octant) {
        if (((tree.levels[h - 1][i].octants >> octant) & 1U) == 0) continue;
        for (std::uint32_t axis = 0; axis < 3; ++axis) {
          EXPECT_EQ(children.index[next][axis],
                    2U * parents.index[i][axis] + ((octant >> axis) & 1U));
        }
        ++next;
      }
    }
    EXPECT_EQ(next, children.size());
  }
}

TEST(SphereTree, RefusesChildrenOutOfOrder) {
  voxel::Pyramid pyramid = test::unit_cube(3)->pyramid;
  std::swap(pyramid.levels[2].index[0], pyramid.levels[2].index[1]);
  EXPECT_THROW(make_sphere_tree(pyramid), InvalidArgument);
}

class RandomPoses : public ::testing::TestWithParam<int> {};

TEST_P(RandomPoses, DescentEqualsBruteForce) {
  Random random(static_cast<std::uint64_t>(GetParam()));
  const std::array shapes{test::unit_cube(5), test::six_legs(5), test::ring(5),
                          test::bumpy_ball(5)};
  std::size_t touching = 0;
  for (int repeat = 0; repeat < 6; ++repeat) {
    const auto& a = shapes[random.next_u32() % shapes.size()];
    const auto& b = shapes[random.next_u32() % shapes.size()];
    const Pose X_BA{random.uniform(0.4, 1.6) * random.unit_vector(), random.rotation()};
    for (int level = 1; level <= 5; ++level) {
      for (const double margin : {0.0, 0.07}) {
        const auto expected = brute_force(a->pyramid, b->pyramid, X_BA, level, margin);
        const Descent found(a->pyramid, b->pyramid, X_BA, level, margin);
        EXPECT_EQ(voxel_pairs(found.overlaps), expected)
            << a->name << " and " << b->name << ", level " << level << ", margin " << margin;
        touching += expected.empty() ? 0U : 1U;

        const DescentTrace trace = descend_with_trace(a->pyramid, b->pyramid, X_BA, level, margin);
        if (expected.empty()) {
          EXPECT_TRUE(trace.colliding.back().empty());
        } else {
          EXPECT_EQ(trace.colliding.back(), expected);
        }
        // Single precision prunes a little less, never more.
        for (std::size_t h = 0; h < found.tests.size(); ++h) {
          EXPECT_GE(found.tests[h], trace.tests[h]);
          EXPECT_LE(static_cast<double>(found.tests[h]),
                    1.02 * static_cast<double>(trace.tests[h]) + 64.0);
        }
      }
    }
  }
  EXPECT_GT(touching, 10U);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomPoses, ::testing::Range(0, 12));

TEST(Descent, BodiesOfVeryDifferentSize) {
  Random random(3);
  const auto big = test::make_test_shape("big", {Vec3(-50, -50, -50), 100.0}, 5, Vec3::Zero(),
                                         [](const Vec3& x) { return x.norm() < 49.0; });
  const auto small = test::six_legs(5);
  std::size_t touching = 0;
  for (int repeat = 0; repeat < 10; ++repeat) {
    const Pose X_BA{random.uniform(48.0, 54.0) * random.unit_vector(), random.rotation()};
    const auto expected = brute_force(small->pyramid, big->pyramid, X_BA, 5, 0.0);
    EXPECT_EQ(voxel_pairs(Descent(small->pyramid, big->pyramid, X_BA, 5, 0.0).overlaps), expected);
    touching += expected.empty() ? 0U : 1U;
  }
  EXPECT_GT(touching, 2U);
}

TEST(Descent, ExactTouchAtEveryLevelOfAxisAlignedCubes) {
  // Two cubes whose corner spheres touch exactly: the coarse spheres overlap, the finest decide.
  const auto cube = test::unit_cube(6);
  for (int level = 1; level <= 6; ++level) {
    const double s = cube->pyramid.grid.voxel_edge(level);
    const double r = cube->pyramid.grid.voxel_radius(level);
    // Facing voxels are 2 r apart centre to centre when the cubes are 2 r - s apart.
    const double touch = 1.0 + 2.0 * r - s;
    for (const double offset : {-1e-9, 1e-9}) {
      const Pose X_BA{Vec3(0, 0, touch + offset), Quat::Identity()};
      const Descent found(cube->pyramid, cube->pyramid, X_BA, level, 0.0);
      const auto n = static_cast<std::size_t>(1) << (2 * (level - 1));
      EXPECT_EQ(found.overlaps.size(), offset < 0.0 ? n : 0U) << "level " << level;
    }
  }
}

TEST(Descent, EveryParentOfAContactCollides) {
  const auto a = test::six_legs(6);
  const auto b = test::bumpy_ball(6);
  const Pose X_BA{Vec3(0.9, 0.5, 0.3), Quat(0.9, 0.1, 0.3, -0.2).normalized()};
  const DescentTrace trace = descend_with_trace(a->pyramid, b->pyramid, X_BA, 6, 0.0);
  ASSERT_EQ(trace.colliding.size(), 6U);
  ASSERT_FALSE(trace.colliding.back().empty());
  for (std::size_t h = 6; h >= 2; --h) {
    const auto parent = [h](const voxel::Pyramid& p, std::uint32_t child) {
      const auto& first = p.levels[h - 2].first_child;
      return static_cast<std::uint32_t>(std::upper_bound(first.begin(), first.end(), child) -
                                        first.begin() - 1);
    };
    const std::set<VoxelPair> parents(trace.colliding[h - 2].begin(), trace.colliding[h - 2].end());
    for (const VoxelPair& pair : trace.colliding[h - 1]) {
      EXPECT_TRUE(parents.contains({parent(a->pyramid, pair.a), parent(b->pyramid, pair.b)}));
    }
  }
}

TEST(Descent, FarApartCostsOneTest) {
  const auto cube = test::unit_cube(4);
  const Descent found(cube->pyramid, cube->pyramid, {Vec3(3, 0, 0), Quat::Identity()}, 4, 0.0);
  EXPECT_TRUE(found.overlaps.empty());
  EXPECT_EQ(found.tests, (TestCounts{1}));
}

}  // namespace
}  // namespace gotai::collision
