#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "gotai/collision/find_contacts.h"
#include "gotai/core/error.h"
#include "gotai/core/parallel.h"
#include "gotai/core/random.h"
#include "support/voxel_shapes.h"

namespace gotai::collision {
namespace {

using model::BodyIndex;
using model::BodyState;
using model::ContactSet;
using model::Geometry;

struct Scene {
  BodyState bodies;
  std::vector<std::shared_ptr<const voxel::Shape>> shapes;
  model::CollisionSettings settings;
  CollisionCache cache;
  SearchStatistics statistics;

  explicit Scene(int level) : settings{model::CollisionModel::spheres, level} {}
  std::uint32_t add_shape(std::shared_ptr<const voxel::Shape> shape) {
    shapes.push_back(std::move(shape));
    return static_cast<std::uint32_t>(shapes.size() - 1);
  }
  BodyIndex add(std::uint32_t shape, const Pose& pose, bool dynamic = true) {
    return test::add_test_body(bodies, *shapes[shape], shape, pose, settings.level, dynamic);
  }
  ContactSet find(double margin = 0.0) {
    ContactSet out;
    statistics = find_contacts(bodies, shapes, settings, margin, cache, out);
    model::validate(out, bodies.size());
    return out;
  }
};

/// gap = n . (x_A(anchor_A) - x_B(anchor_B)), and the anchors lie on the line of the normal.
void expect_anchors_agree(const BodyState& bodies, const ContactSet& contacts) {
  for (const model::ContactPair& pair : contacts.pairs) {
    for (std::uint32_t i = pair.begin; i < pair.end; ++i) {
      const Vec3 on_a = bodies.x_W[pair.body_a] + bodies.q_WB[pair.body_a] * contacts.anchor_A[i];
      const Vec3 on_b = bodies.x_W[pair.body_b] + bodies.q_WB[pair.body_b] * contacts.anchor_B[i];
      EXPECT_LT((on_a - on_b - contacts.gap[i] * contacts.normal_W[i]).norm(), 1e-13);
      EXPECT_EQ(contacts.area[i], 1.0);
    }
  }
}

void expect_same_bits(const ContactSet& a, const ContactSet& b) {
  const auto same = [](const auto& x, const auto& y) {
    return x.size() == y.size() &&
           std::memcmp(x.data(), y.data(), x.size() * sizeof(*x.data())) == 0;
  };
  EXPECT_TRUE(same(a.pairs, b.pairs));
  EXPECT_TRUE(same(a.point_W, b.point_W));
  EXPECT_TRUE(same(a.normal_W, b.normal_W));
  EXPECT_TRUE(same(a.gap, b.gap));
  EXPECT_TRUE(same(a.anchor_A, b.anchor_A));
  EXPECT_TRUE(same(a.anchor_B, b.anchor_B));
  EXPECT_TRUE(same(a.area, b.area));
  EXPECT_TRUE(same(a.feature, b.feature));
}

// A flat face on the floor gives 4x4 contacts at level 3, 8x8 at level 4, 16x16 at level 5
// [Makino 2007, section 4.2.1]; the cube floats by the sphere offset 0.366 s (erratum 45).
TEST(FindContacts, FlatCubeOnTheFloor) {
  for (int level = 1; level <= 6; ++level) {
    Scene scene(level);
    scene.add_shape(test::unit_cube(6));
    const double s = scene.shapes[0]->pyramid.grid.voxel_edge(level);
    const double r = scene.shapes[0]->pyramid.grid.voxel_radius(level);
    const double rest = 0.5 + r - 0.5 * s;  // height of the centre when the spheres touch
    scene.add(0, {Vec3(0.3, -0.2, rest - 1e-3), Quat::Identity()});
    test::add_test_boundary(scene.bodies, Geometry::plane);
    const ContactSet contacts = scene.find();
    ASSERT_EQ(contacts.pairs.size(), 1U);
    EXPECT_EQ(contacts.pairs[0].body_a, 0U);
    EXPECT_EQ(contacts.pairs[0].body_b, 1U);
    EXPECT_EQ(contacts.size(), static_cast<std::size_t>(1) << (2 * (level - 1)));
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      EXPECT_NEAR(contacts.gap[i], -1e-3, 1e-15);
      EXPECT_EQ(contacts.normal_W[i], Vec3::UnitZ());
      EXPECT_NEAR(contacts.point_W[i].z(), -1e-3, 1e-15);
    }
    expect_anchors_agree(scene.bodies, contacts);

    scene.bodies.x_W[0].z() = rest + 1e-3;
    EXPECT_EQ(scene.find().size(), 0U);
    EXPECT_TRUE(scene.find().pairs.empty());
    EXPECT_EQ(scene.find(2e-3).size(), contacts.size());
  }
}

TEST(FindContacts, TiltedPlaneTouchesInItsOwnFrame) {
  Scene scene(4);
  scene.add_shape(test::unit_cube(4));
  const Quat tilt(Eigen::AngleAxisd(0.7, Vec3(1, 2, 0.5).normalized()));
  const double s = scene.shapes[0]->pyramid.grid.voxel_edge(4);
  const double r = scene.shapes[0]->pyramid.grid.voxel_radius(4);
  const Vec3 origin(3, -1, 2);
  test::add_test_boundary(scene.bodies, Geometry::plane, {origin, tilt});
  scene.add(0, {origin + tilt * Vec3(5, 7, 0.5 + r - 0.5 * s - 1e-4), tilt});
  const ContactSet contacts = scene.find();
  ASSERT_EQ(contacts.size(), 64U);
  EXPECT_EQ(contacts.pairs[0].body_a, 1U);
  EXPECT_EQ(contacts.pairs[0].body_b, 0U);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    EXPECT_NEAR(contacts.gap[i], -1e-4, 1e-14);
    EXPECT_LT((contacts.normal_W[i] - tilt * Vec3::UnitZ()).norm(), 1e-15);
  }
  expect_anchors_agree(scene.bodies, contacts);
}

TEST(FindContacts, TwoSpheresAtLevelOne) {
  // Level 1 is one sphere per body, of different radii; the centres of mass are elsewhere.
  Scene scene(1);
  const auto all = [](const Vec3&) { return true; };
  scene.add_shape(test::make_test_shape("a", {Vec3(0, 0, 0), 2.0}, 1, Vec3(0.9, 1.2, 1.0), all));
  scene.add_shape(test::make_test_shape("b", {Vec3(-0.5, -0.5, -0.5), 1.0}, 1, Vec3::Zero(), all));
  const BodyIndex a = scene.add(0, {Vec3::Zero(), Quat(0.8, 0.2, -0.4, 0.1).normalized()});
  const BodyIndex b = scene.add(1, {Vec3(1.5, 1.0, -0.5), Quat(0.3, 0.7, 0.1, 0.2).normalized()});
  scene.bodies.p_MB[a] = Vec3(0.9, 1.2, 1.0);
  const Vec3 c_A = scene.bodies.mesh_pose(a) * Vec3(1, 1, 1);
  const Vec3 c_B = scene.bodies.mesh_pose(b) * Vec3(0, 0, 0);
  const double r_A = std::sqrt(3.0);
  const double r_B = std::sqrt(3.0) / 2.0;
  const ContactSet contacts = scene.find();
  ASSERT_EQ(contacts.size(), 1U);
  EXPECT_NEAR(contacts.gap[0], (c_A - c_B).norm() - r_A - r_B, 1e-14);
  EXPECT_LT((contacts.normal_W[0] - (c_A - c_B).normalized()).norm(), 1e-14);
  EXPECT_LT((contacts.point_W[0] - (c_B + r_B / (r_A + r_B) * (c_A - c_B))).norm(), 1e-14);
  expect_anchors_agree(scene.bodies, contacts);
}

TEST(FindContacts, AgreesWithBruteForceOverAllLeafSpheres) {
  Random random(5);
  Scene scene(4);
  scene.add_shape(test::six_legs(5));
  scene.add_shape(test::bumpy_ball(4));
  scene.add_shape(test::ring(6));
  for (int i = 0; i < 24; ++i) {
    scene.add(random.next_u32() % 3,
              {random.uniform(0.0, 2.0) * random.unit_vector(), random.rotation()}, i % 5 != 0);
  }
  test::add_test_boundary(scene.bodies, Geometry::plane, {Vec3(0, 0, -1), Quat::Identity()});
  const BodyState& bodies = scene.bodies;
  for (const double margin : {0.0, 0.05}) {
    const ContactSet contacts = scene.find(margin);
    expect_anchors_agree(bodies, contacts);
    std::size_t found = 0;
    std::size_t expected = 0;
    for (BodyIndex a = 0; a < 24; ++a) {
      const voxel::Pyramid& p_a = scene.shapes[bodies.shape[a]]->pyramid;
      for (BodyIndex b = 0; b < bodies.size(); ++b) {
        const bool a_is_first = bodies.is_dynamic(a) && (!bodies.is_dynamic(b) || a < b);
        if (a == b || !a_is_first) continue;
        std::vector<model::FeatureKey> keys;
        std::vector<double> gaps;
        for (std::uint32_t i = 0; i < p_a.level(4).size(); ++i) {
          const Vec3 c_A = bodies.mesh_pose(a) * p_a.voxel_center(4, i);
          const double r_A = p_a.grid.voxel_radius(4);
          if (bodies.geometry[b] == Geometry::plane) {
            if (c_A.z() + 1.0 - r_A > margin) continue;
            keys.push_back(i);
            gaps.push_back(c_A.z() + 1.0 - r_A);
            continue;
          }
          const voxel::Pyramid& p_b = scene.shapes[bodies.shape[b]]->pyramid;
          for (std::uint32_t j = 0; j < p_b.level(4).size(); ++j) {
            const Vec3 c_B = bodies.mesh_pose(b) * p_b.voxel_center(4, j);
            const double gap = (c_A - c_B).norm() - r_A - p_b.grid.voxel_radius(4);
            if (gap > margin) continue;
            keys.push_back(static_cast<model::FeatureKey>(i) << 32U | j);
            gaps.push_back(gap);
          }
        }
        expected += keys.size();
        const auto pair =
            std::find_if(contacts.pairs.begin(), contacts.pairs.end(),
                         [a, b](const auto& p) { return p.body_a == a && p.body_b == b; });
        if (pair == contacts.pairs.end()) {
          EXPECT_TRUE(keys.empty());
          continue;
        }
        found += pair->size();
        ASSERT_EQ(std::vector(contacts.feature.begin() + pair->begin,
                              contacts.feature.begin() + pair->end),
                  keys);
        for (std::uint32_t i = 0; i < pair->size(); ++i) {
          EXPECT_NEAR(contacts.gap[pair->begin + i], gaps[i], 1e-13);
        }
      }
    }
    EXPECT_EQ(found, expected);
    EXPECT_EQ(contacts.size(), expected);
    EXPECT_GT(expected, 1000U);
  }
}

TEST(FindContacts, CoincidentCentresFallBackToTheCentresOfMassOrUp) {
  Scene scene(2);
  scene.add_shape(test::unit_cube(2));
  scene.add(0, {Vec3(1, 2, 3), Quat::Identity()});
  scene.add(0, {Vec3(1, 2, 3), Quat::Identity()});
  const double r = scene.shapes[0]->pyramid.grid.voxel_radius(2);
  const auto coincident = [](const ContactSet& contacts) {
    std::vector<std::uint32_t> found;
    for (std::uint32_t i = 0; i < contacts.size(); ++i) {
      if ((contacts.feature[i] >> 32U) == (contacts.feature[i] & 0xffffffffU)) found.push_back(i);
    }
    return found;
  };
  ContactSet contacts = scene.find();
  ASSERT_EQ(coincident(contacts).size(), 8U);
  for (const std::uint32_t i : coincident(contacts)) {
    EXPECT_EQ(contacts.normal_W[i], Vec3::UnitZ());
    EXPECT_DOUBLE_EQ(contacts.gap[i], -2.0 * r);
  }
  expect_anchors_agree(scene.bodies, contacts);

  // Same meshes, other centres of mass: the direction from b's to a's.
  scene.bodies.p_MB[0] = Vec3(0.1, 0, 0);
  scene.bodies.x_W[0] += Vec3(0.1, 0, 0);
  contacts = scene.find();
  ASSERT_EQ(coincident(contacts).size(), 8U);
  for (const std::uint32_t i : coincident(contacts)) {
    EXPECT_LT((contacts.normal_W[i] - Vec3::UnitX()).norm(), 1e-14);
  }
  expect_anchors_agree(scene.bodies, contacts);
}

TEST(FindContacts, FixedBodiesTouchOnlyDynamicOnes) {
  Scene scene(3);
  scene.add_shape(test::unit_cube(3));
  scene.add(0, {Vec3(0, 0, 0), Quat::Identity()}, false);
  scene.add(0, {Vec3(0.5, 0, 0), Quat::Identity()}, false);
  test::add_test_boundary(scene.bodies, Geometry::plane);
  EXPECT_EQ(scene.find().size(), 0U);
  scene.add(0, {Vec3(0, 0, 1.0), Quat::Identity()});
  const ContactSet contacts = scene.find();
  ASSERT_EQ(contacts.pairs.size(), 2U);
  EXPECT_EQ(contacts.pairs[0].body_a, 3U);
  EXPECT_EQ(contacts.pairs[0].body_b, 0U);
  EXPECT_EQ(contacts.pairs[1].body_a, 3U);
  EXPECT_EQ(contacts.pairs[1].body_b, 1U);
  for (std::size_t i = 0; i < contacts.size(); ++i) EXPECT_GT(contacts.normal_W[i].z(), 0.0);
}

class Container : public ::testing::Test {
 protected:
  Container() : scene_(3) {
    scene_.add_shape(test::unit_cube(3));
    test::add_test_boundary(scene_.bodies, Geometry::container, {}, Vec3(2, 3, 4));
    offset_ = scene_.shapes[0]->pyramid.grid.voxel_radius(3) -
              0.5 * scene_.shapes[0]->pyramid.grid.voxel_edge(3);
    scene_.add(0, {});
  }
  /// Contacts of the cube at a place, by face.
  std::array<std::size_t, 5> count(const Vec3& x) {
    scene_.bodies.x_W[1] = x;
    contacts_ = scene_.find();
    expect_anchors_agree(scene_.bodies, contacts_);
    std::array<std::size_t, 5> by_face{};
    for (const model::FeatureKey key : contacts_.feature) ++by_face[key >> 32U];
    return by_face;
  }
  Scene scene_;
  ContactSet contacts_;
  double offset_;  // the cube's face is this far from the surface of its spheres
};

using ByFace = std::array<std::size_t, 5>;

TEST_F(Container, FloorAndWalls) {
  const double touch = 0.5 + offset_ - 1e-3;
  EXPECT_EQ(count(Vec3(0, 0, 2)), (ByFace{}));
  EXPECT_EQ(count(Vec3(0, 0, touch)), (ByFace{16, 0, 0, 0, 0}));
  EXPECT_EQ(count(Vec3(-2 + touch, 0, 2)), (ByFace{0, 16, 0, 0, 0}));
  EXPECT_EQ(contacts_.normal_W[0], Vec3::UnitX());
  EXPECT_EQ(count(Vec3(2 - touch, 0, 2)), (ByFace{0, 0, 16, 0, 0}));
  EXPECT_EQ(contacts_.normal_W[0], Vec3(-Vec3::UnitX()));
  EXPECT_EQ(count(Vec3(0, -3 + touch, 2)), (ByFace{0, 0, 0, 16, 0}));
  EXPECT_EQ(contacts_.normal_W[0], Vec3::UnitY());
  EXPECT_EQ(count(Vec3(0, 3 - touch, 2)), (ByFace{0, 0, 0, 0, 16}));
  EXPECT_EQ(contacts_.normal_W[0], Vec3(-Vec3::UnitY()));
  EXPECT_NEAR(contacts_.gap[0], -1e-3, 1e-14);
  // In the corner, one pair with three faces.
  EXPECT_EQ(count(Vec3(2 - touch, 3 - touch, touch)), (ByFace{16, 0, 16, 0, 16}));
  EXPECT_EQ(contacts_.pairs.size(), 1U);
}

TEST_F(Container, WallsEndAtTheRim) {
  const double touch = 0.5 + offset_ - 1e-3;
  // Rows of centres at z - 0.375, -0.125, +0.125, +0.375.
  EXPECT_EQ(count(Vec3(2 - touch, 0, 4.0)), (ByFace{0, 0, 8, 0, 0}));
  EXPECT_EQ(count(Vec3(2 - touch, 0, 4.2)), (ByFace{0, 0, 4, 0, 0}));
  EXPECT_EQ(count(Vec3(2 - touch, 0, 4.4)), (ByFace{}));
}

TEST_F(Container, WhatIsOutsideIsLeftAlone) {
  EXPECT_EQ(count(Vec3(2.7, 0, 2)), (ByFace{}));
  EXPECT_EQ(count(Vec3(0, -40, -3)), (ByFace{}));
  // Half through a wall with the centre of mass inside: the two layers of voxels behind it
  // are pushed back (the four in the middle of a layer are no surface).
  EXPECT_EQ(count(Vec3(1.9, 0, 2))[2], 16U + 12U);
}

TEST(FindContacts, TheSameBitsForOneAndTwoThreadsAndForAFreshCache) {
  Random random(11);
  Scene scene(5);
  scene.add_shape(test::six_legs(5));
  scene.add_shape(test::bumpy_ball(5));
  for (int i = 0; i < 60; ++i) {
    scene.add(random.next_u32() % 2,
              {random.uniform(0.0, 3.0) * random.unit_vector(), random.rotation()});
  }
  test::add_test_boundary(scene.bodies, Geometry::container, {Vec3(0, 0, -2), Quat::Identity()},
                          Vec3(2, 2, 1));
  const auto find_with = [&](int threads) {
    const ThreadLimit limit(threads);
    return scene.find();
  };
  const ContactSet one = find_with(1);
  EXPECT_GT(one.pairs.size(), 100U);
  const SearchStatistics statistics_one = scene.statistics;
  expect_same_bits(one, find_with(2));
  EXPECT_EQ(scene.statistics.tests_per_level, statistics_one.tests_per_level);
  expect_same_bits(one, find_with(0));
  scene.cache = CollisionCache();
  expect_same_bits(one, find_with(2));
}

TEST(FindContacts, CountsItsTests) {
  Scene scene(3);
  scene.add_shape(test::unit_cube(3));
  scene.add(0, {Vec3(0, 0, 0), Quat::Identity()});
  scene.add(0, {Vec3(0, 0, 10), Quat::Identity()});
  scene.find();
  EXPECT_EQ(scene.statistics.candidate_pairs, 0U);
  EXPECT_EQ(scene.statistics.tests, 0U);
  // Face to face: 8x8 tests at level 2; then the spheres of facing voxels, next to and diagonal to
  // each other, all overlap: 4x4 pairs, 7x7 children each (the cube's inner voxels are not
  // surface).
  scene.bodies.x_W[1] = Vec3(0, 0, 1.0);
  scene.find();
  EXPECT_EQ(scene.statistics.candidate_pairs, 1U);
  EXPECT_EQ(scene.statistics.tests_per_level[0], 1U);
  EXPECT_EQ(scene.statistics.tests_per_level[1], 64U);
  EXPECT_EQ(scene.statistics.tests_per_level[2], 16U * 49U);
  EXPECT_EQ(scene.statistics.tests, 65U + scene.statistics.tests_per_level[2]);
}

TEST(FindContacts, ALevelBeyondThePreparedOneIsAnError) {
  Scene scene(3);
  scene.add_shape(test::unit_cube(3));
  scene.add(0, {});
  scene.settings.level = 4;
  try {
    scene.find();
    FAIL() << "no error";
  } catch (const InvalidArgument& e) {
    EXPECT_THAT(e.what(), ::testing::AllOf(::testing::HasSubstr("collision.level"),
                                           ::testing::HasSubstr("'cube' is prepared to level 3"),
                                           ::testing::HasSubstr("prepare it to level 4")));
  }
  scene.settings.level = 0;
  EXPECT_THROW(scene.find(), InvalidArgument);
}

TEST(FindContacts, AReplacedShapeIsNoticed) {
  Scene scene(3);
  scene.add_shape(test::unit_cube(3));
  scene.add(0, {Vec3(0, 0, 0.5), Quat::Identity()});
  test::add_test_boundary(scene.bodies, Geometry::plane);
  EXPECT_EQ(scene.find().size(), 16U);
  scene.shapes[0] = test::ring(3);
  scene.bodies.x_W[0].z() = 0.1;
  const ContactSet contacts = scene.find();
  EXPECT_GT(contacts.size(), 0U);
  Scene fresh(3);
  fresh.shapes = scene.shapes;
  fresh.bodies = scene.bodies;
  expect_same_bits(contacts, fresh.find());
}

}  // namespace
}  // namespace gotai::collision
