// The surface model: the search against brute force, and the contacts of simple arrangements.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "gotai/collision/find_contacts.h"
#include "gotai/collision/surface_contacts.h"
#include "gotai/collision/surface_sample.h"
#include "gotai/collision/surface_search.h"
#include "gotai/core/error.h"
#include "gotai/core/parallel.h"
#include "gotai/core/random.h"
#include "gotai/geometry/generate.h"

namespace gotai::collision {
namespace {

using model::BodyIndex;
using model::BodyState;
using model::ContactSet;

using ShapePointer = std::shared_ptr<const voxel::Shape>;

ShapePointer make(const std::string& name, int surface_level, double size = 1.0) {
  geometry::GeneratorOptions options;
  options.shape = name;
  options.size = size;
  voxel::ShapeOptions shape_options;
  shape_options.prepared_level = 4;
  shape_options.surface_level = surface_level;
  return std::make_shared<const voxel::Shape>(
      voxel::make_shape(name, geometry::generate(options), shape_options));
}

Vec3 point_of(const voxel::SurfaceTree& tree, std::size_t i) {
  const voxel::PointPacket& p = tree.points[i / voxel::kLanes];
  return {p.x[i % voxel::kLanes], p.y[i % voxel::kLanes], p.z[i % voxel::kLanes]};
}

class Search : public testing::TestWithParam<std::string> {};

// Pruning loses nothing and finds nothing else, near and far, shallow and deep.
TEST_P(Search, FindsWhatLookingAtEverySampleFinds) {
  const ShapePointer a = make(GetParam(), 5);
  const ShapePointer b = make("hexapod", 5);
  const voxel::SurfaceTree& tree = a->surface.tree;
  const voxel::DistanceField& field = b->surface.field;
  Random random(11);
  SurfaceSearch search;
  std::size_t found = 0;
  std::uint64_t all = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const Mat3 R = random.rotation().toRotationMatrix();
    const Vec3 t = random.uniform(0.0, 1.2) * random.unit_vector();
    for (const double margin : {0.0, 0.01, 0.05, 0.3}) {
      search_field(tree, field, make_sample_pose(R, t), static_cast<float>(margin), search);
      std::size_t k = 0;
      for (std::size_t i = 0; i < tree.size(); ++i) {
        const voxel::FieldValue exact = voxel::evaluate(field, R * point_of(tree, i) + t);
        const bool hit = k < search.hits.size() && search.hits[k].sample == i;
        if (std::abs(exact.distance - margin) > 1e-6) {
          ASSERT_EQ(hit, exact.distance < margin) << i << " at " << exact.distance;
        }
        if (!hit) continue;
        const SurfaceHit& h = search.hits[k++];
        ASSERT_NEAR(static_cast<double>(h.distance), exact.distance, 2e-6);
        for (int axis = 0; axis < 3; ++axis) {
          ASSERT_NEAR(static_cast<double>(h.gradient[static_cast<std::size_t>(axis)]),
                      exact.gradient[axis], 1e-3);
        }
      }
      ASSERT_EQ(k, search.hits.size());
      found += k;
      all += tree.size();
    }
  }
  EXPECT_GT(found, 1000U);
  EXPECT_LT(search.tests, all) << "pruning is useless";
}

// The same hits however far spheres are descended into, and where there are none to look at, no
// sample comes nearer than was promised, wherever it moves.
TEST_P(Search, ClearanceHoldsForEverySampleAndMotion) {
  const ShapePointer a = make(GetParam(), 5);
  const ShapePointer b = make("hexapod", 5);
  const voxel::SurfaceTree& tree = a->surface.tree;
  const voxel::DistanceField& field = b->surface.field;
  Random random(21);
  SurfaceSearch plain;
  SurfaceSearch wide;
  int promises = 0;
  double tightest = 1.0;
  for (int trial = 0; trial < 400; ++trial) {
    const Mat3 R = random.rotation().toRotationMatrix();
    const Vec3 t = random.uniform(0.3, 1.5) * random.unit_vector();
    const SamplePose pose = make_sample_pose(R, t);
    const auto margin = static_cast<float>(random.uniform(0.0, 0.1));
    const auto up_to = margin + static_cast<float>(random.uniform(0.0, 0.1));
    search_field(tree, field, pose, margin, plain);
    search_field_widely(tree, field, pose, margin, up_to, wide);
    ASSERT_EQ(plain.hits.size(), wide.hits.size());
    ASSERT_EQ(
        std::memcmp(plain.hits.data(), wide.hits.data(), plain.hits.size() * sizeof(SurfaceHit)),
        0);
    if (wide.clearance < 0.0F) continue;
    ASSERT_TRUE(plain.hits.empty());
    ++promises;
    const auto clearance = static_cast<double>(wide.clearance);
    double least = 1.0;
    for (std::size_t i = 0; i < tree.size(); ++i) {
      const Vec3 x = R * point_of(tree, i) + t;
      least = std::min(least, voxel::evaluate(field, x).distance);
      // Straight towards the other body is worst; any other way is allowed, too.
      const double d = random.uniform(0.0, 0.6);
      const Vec3 way = trial % 2 == 0 ? Vec3(-x.normalized()) : random.unit_vector();
      const double there = voxel::evaluate(field, x + d * way).distance;
      ASSERT_GE(there, std::min(clearance - d, static_cast<double>(up_to)) - 1e-5);
    }
    tightest = std::min(tightest, least - clearance);
  }
  EXPECT_GT(promises, 20);
  EXPECT_LT(tightest, 0.2) << "promises nothing";
}

// Bits, not values: what a run computes must not depend on the processor.
TEST_P(Search, GivesTheSameBitsOnEveryKernel) {
  for (const Kernel kernel : {Kernel::avx2, Kernel::avx512}) {
    if (!is_available(kernel)) continue;
    const ShapePointer a = make(GetParam(), 5);
    const ShapePointer b = make("rock", 5);
    Random random(12);
    SurfaceSearch portable;
    SurfaceSearch other;
    const auto equal = [&] {
      return portable.hits.size() == other.hits.size() && portable.tests == other.tests &&
             std::memcmp(portable.hits.data(), other.hits.data(),
                         portable.hits.size() * sizeof(SurfaceHit)) == 0;
    };
    std::size_t found = 0;
    for (int trial = 0; trial < 200; ++trial) {
      const SamplePose pose = make_sample_pose(random.rotation().toRotationMatrix(),
                                               random.uniform(0.0, 1.3) * random.unit_vector());
      const auto margin = static_cast<float>(random.uniform(0.0, 0.3));
      search_field(a->surface.tree, b->surface.field, pose, margin, portable, Kernel::portable);
      search_field(a->surface.tree, b->surface.field, pose, margin, other, kernel);
      ASSERT_TRUE(equal());
      search_field_widely(a->surface.tree, b->surface.field, pose, margin, 2.0F * margin, portable,
                          Kernel::portable);
      search_field_widely(a->surface.tree, b->surface.field, pose, margin, 2.0F * margin, other,
                          kernel);
      ASSERT_TRUE(equal());
      ASSERT_EQ(portable.clearance, other.clearance);
      found += portable.hits.size();
      const Eigen::Vector3f n = random.unit_vector().cast<float>();
      const auto offset = static_cast<float>(random.uniform(-0.2, 0.6));
      search_half_space(a->surface.tree, {n.x(), n.y(), n.z()}, offset, margin, portable,
                        Kernel::portable);
      search_half_space(a->surface.tree, {n.x(), n.y(), n.z()}, offset, margin, other, kernel);
      ASSERT_TRUE(equal());
    }
    EXPECT_GT(found, 1000U);
  }
}
INSTANTIATE_TEST_SUITE_P(Shapes, Search, testing::Values("hexapod", "rock", "torus", "cube"));

TEST(SurfaceSearch, FindsEverySampleBelowAPlane) {
  const ShapePointer a = make("rock", 5);
  Random random(13);
  SurfaceSearch search;
  for (int trial = 0; trial < 100; ++trial) {
    const Vec3 n = random.unit_vector();
    const double offset = random.uniform(-0.6, 0.6);
    const double margin = random.uniform(0.0, 0.2);
    const Eigen::Vector3f f = n.cast<float>();
    search_half_space(a->surface.tree, {f.x(), f.y(), f.z()}, static_cast<float>(offset),
                      static_cast<float>(margin), search);
    std::size_t k = 0;
    for (std::size_t i = 0; i < a->surface.tree.size(); ++i) {
      const double height = n.dot(point_of(a->surface.tree, i)) + offset;
      const bool hit = k < search.hits.size() && search.hits[k].sample == i;
      if (std::abs(height - margin) > 1e-5) {
        ASSERT_EQ(hit, height < margin);
      }
      k += hit ? 1 : 0;
    }
    ASSERT_EQ(k, search.hits.size());
  }
}

// Bodies of shapes, planes and containers in one world.
class World {
 public:
  BodyIndex add_shape(const ShapePointer& shape, const Vec3& x, const Quat& q = Quat::Identity()) {
    const BodyIndex i = model::append_body(bodies);
    bodies.geometry[i] = model::Geometry::shape;
    bodies.kind[i] = model::BodyKind::dynamic;
    bodies.shape[i] = static_cast<std::uint32_t>(shapes.size());
    shapes.push_back(shape);
    model::set_mass(bodies, i, shape->mass.volume, shape->mass.inertia);
    bodies.p_MB[i] = shape->mass.center_of_mass;
    bodies.bounding_radius[i] = shape->bounding_radius;
    bodies.x_W[i] = x;
    bodies.q_WB[i] = q;
    model::refresh_derived(bodies, i);
    return i;
  }
  BodyIndex add_plane(const Vec3& x, const Quat& q) {
    const BodyIndex i = model::append_body(bodies);
    bodies.geometry[i] = model::Geometry::plane;
    bodies.x_W[i] = x;
    bodies.q_WB[i] = q;
    return i;
  }
  BodyIndex add_container(const Vec3& half_extent) {
    const BodyIndex i = model::append_body(bodies);
    bodies.geometry[i] = model::Geometry::container;
    bodies.half_extent[i] = half_extent;
    return i;
  }
  const ContactSet& find(double margin) {
    settings.model = model::CollisionModel::surface;
    find_contacts(bodies, shapes, settings, margin, cache, contacts);
    validate(contacts, bodies.size());
    // Every contact is what its anchors say.
    for (const model::ContactPair& pair : contacts.pairs) {
      for (std::size_t c = pair.begin; c < pair.end; ++c) {
        const Vec3 a = bodies.x_W[pair.body_a] + bodies.q_WB[pair.body_a] * contacts.anchor_A[c];
        const Vec3 b = bodies.x_W[pair.body_b] + bodies.q_WB[pair.body_b] * contacts.anchor_B[c];
        EXPECT_NEAR(contacts.normal_W[c].dot(a - b), contacts.gap[c], 1e-9);
        EXPECT_NEAR((contacts.point_W[c] - 0.5 * (a + b)).norm(), 0.0, 1e-9);
        EXPECT_LE(contacts.gap[c], margin);
        EXPECT_GE(contacts.area[c], 0.0);
      }
    }
    return contacts;
  }

  BodyState bodies;
  std::vector<ShapePointer> shapes;
  model::CollisionSettings settings;
  CollisionCache cache;
  ContactSet contacts;
};

TEST(SurfaceContacts, OfACubeOnAPlaneCarryItsFaceExactly) {
  World world;
  Random random(14);
  const Quat q = random.rotation();
  const Vec3 up = q * Vec3::UnitZ();
  world.add_plane({1.0, 2.0, 3.0}, q);
  world.add_shape(make("cube", 5), Vec3(1.0, 2.0, 3.0) + q * Vec3(0.3, 0.2, 0.499), q);
  const ContactSet& contacts = world.find(0.01);
  ASSERT_EQ(contacts.pairs.size(), 1U);
  double area = 0.0;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    EXPECT_NEAR(contacts.gap[c], -0.001, 1e-7);
    EXPECT_NEAR((contacts.normal_W[c] - up).norm(), 0.0, 1e-12);
    area += contacts.area[c];
  }
  EXPECT_NEAR(area, 1.0, 0.01);
}

TEST(SurfaceContacts, OfTwoCubesFaceToFaceHaveTheFacesNormalEverywhere) {
  World world;
  Random random(15);
  const Quat q = random.rotation();
  const ShapePointer cube = make("cube", 5);
  const Quat yaw(Eigen::AngleAxisd(0.4, Vec3::UnitZ()));
  world.add_shape(cube, q * Vec3::Zero(), q);
  world.add_shape(cube, q * Vec3(0.1, 0.05, 0.9995), q * yaw);
  const ContactSet& contacts = world.find(0.002);
  const Vec3 down = q * -Vec3::UnitZ();  // from b, above, to a
  double deepest = 1.0;
  std::size_t beyond_edges = 0;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    deepest = std::min(deepest, contacts.gap[c]);
    if (contacts.gap[c] < -1e-4 && std::abs(contacts.gap[c] + 0.0005) > 1e-5) ++beyond_edges;
    EXPECT_GT(contacts.normal_W[c].dot(down), 0.7);
  }
  EXPECT_NEAR(deepest, -0.0005, 1e-5);
  EXPECT_LT(beyond_edges, contacts.size() / 4);
}

TEST(SurfaceContacts, OfSpheresConvergeInTheGap) {
  double previous = 0.0;
  for (const int level : {3, 4, 5}) {
    geometry::GeneratorOptions options;
    options.shape = "sphere";
    options.subdivisions = 32;
    voxel::ShapeOptions shape_options;
    shape_options.prepared_level = 3;
    shape_options.surface_level = level;
    const auto ball = std::make_shared<const voxel::Shape>(
        voxel::make_shape("ball", geometry::generate(options), shape_options));
    Random random(16);
    double squared = 0.0;
    const int trials = 40;
    for (int trial = 0; trial < trials; ++trial) {
      World world;
      const Vec3 n = random.unit_vector();
      world.add_shape(ball, Vec3::Zero(), random.rotation());
      world.add_shape(ball, 1.001 * n, random.rotation());
      const ContactSet& contacts = world.find(0.1);
      const double gap = *std::min_element(contacts.gap.begin(), contacts.gap.end());
      squared += (gap - 0.001) * (gap - 0.001);
    }
    const double rms = std::sqrt(squared / trials);
    if (level > 3) {
      EXPECT_GT(std::log2(previous / rms), 1.2) << "level " << level;
    }
    previous = rms;
  }
  EXPECT_LT(previous, 3e-3);
}

TEST(SurfaceContacts, SeeThePlateFromBothSidesHoweverThin) {
  geometry::GeneratorOptions options;
  options.shape = "box";
  options.extents = {1.0, 1.0, 0.02};
  voxel::ShapeOptions shape_options;
  shape_options.prepared_level = 7;
  shape_options.surface_level = 5;
  const auto plate = std::make_shared<const voxel::Shape>(
      voxel::make_shape("plate", geometry::generate(options), shape_options));
  for (const double side : {1.0, -1.0}) {
    World world;
    world.add_shape(plate, Vec3::Zero());
    world.add_shape(make("sphere", 5, 0.4), {0.0, 0.0, side * (0.2 + 0.01 - 0.002)});
    const ContactSet& contacts = world.find(0.0);
    ASSERT_GT(contacts.size(), 0U);
    for (std::size_t c = 0; c < contacts.size(); ++c) {
      EXPECT_LT(contacts.normal_W[c].z() * side, -0.9);
    }
  }
}

TEST(SurfaceContacts, OfAContainerActOnItsFloorAndWalls) {
  World world;
  world.add_container({0.6, 0.7, 2.0});
  world.add_shape(make("cube", 4), {0.105, 0.0, 0.495});
  const ContactSet& contacts = world.find(0.0);
  std::size_t floor = 0;
  std::size_t wall = 0;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    floor += contacts.normal_W[c].z() > 0.99 ? 1 : 0;
    wall += contacts.normal_W[c].x() < -0.99 ? 1 : 0;
    EXPECT_NEAR(contacts.gap[c], -0.005, 1e-6);
  }
  EXPECT_GT(floor, 50U);
  EXPECT_GT(wall, 50U);
  EXPECT_EQ(floor + wall, contacts.size());
}

// The same bits for any number of threads, and a moved cache changes nothing.
TEST(SurfaceContacts, AreTheSameForAnyThreadsAndCache) {
  World world;
  Random random(17);
  const ShapePointer shape = make("hexapod", 5);
  world.add_container({1.2, 1.2, 4.0});
  for (int i = 0; i < 40; ++i) {
    world.add_shape(
        shape, {random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(0.0, 3.0)},
        random.rotation());
  }
  const auto bits = [&](int threads) {
    const ThreadLimit limit(threads);
    CollisionCache cache;
    ContactSet contacts;
    world.settings.model = model::CollisionModel::surface;
    find_contacts(world.bodies, world.shapes, world.settings, 0.02, cache, contacts);
    find_contacts(world.bodies, world.shapes, world.settings, 0.02, cache, contacts);
    return contacts;
  };
  const ContactSet one = bits(1);
  const ContactSet two = bits(2);
  ASSERT_GT(one.size(), 1000U);
  EXPECT_EQ(one.gap, two.gap);
  EXPECT_EQ(one.feature, two.feature);
  EXPECT_EQ(one.normal_W, two.normal_W);
  EXPECT_EQ(one.anchor_A, two.anchor_A);
}

TEST(SurfaceContacts, NeedAPreparedSurface) {
  World world;
  world.add_shape(make("cube", 0), Vec3::Zero());
  EXPECT_THAT([&] { world.find(0.0); },
              testing::ThrowsMessage<InvalidArgument>(testing::HasSubstr("surface level")));
}

TEST(NormalCone, KeepsWhatFitsAndTurnsTheRestToItsRim) {
  const ShapePointer cube = make("cube", 4);
  const voxel::SurfaceTree& tree = cube->surface.tree;
  Random random(18);
  for (std::uint32_t i = 0; i < tree.size(); ++i) {
    const Vec3 axis = to_double(unit_normal(tree.elements[i]));
    EXPECT_NEAR((fit_to_normal_cone(tree, i, axis) - axis).norm(), 0.0, 1e-5);
    EXPECT_TRUE(fit_to_normal_cone(tree, i, -axis).isZero());
    for (int k = 0; k < 10; ++k) {
      const Vec3 fitted = fit_to_normal_cone(tree, i, random.unit_vector());
      if (fitted.isZero()) continue;
      EXPECT_NEAR(fitted.norm(), 1.0, 1e-5);
      EXPECT_GE(fitted.dot(axis), static_cast<double>(tree.elements[i].cone_cosine) - 1e-5);
    }
  }
}

}  // namespace
}  // namespace gotai::collision
