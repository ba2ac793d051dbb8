// Shape preparation of the surface model: exact distances, samples, tree, field.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "gotai/core/error.h"
#include "gotai/core/random.h"
#include "gotai/geometry/generate.h"
#include "gotai/voxel/surface_model.h"

namespace gotai::voxel {
namespace {

using geometry::Mesh;

Mesh make(const std::string& shape, const Vec3& extents = Vec3::Ones()) {
  geometry::GeneratorOptions options;
  options.shape = shape;
  if (shape == "box") options.extents = extents;
  return geometry::generate(options);
}

Vec3 point_of(const SurfaceTree& tree, std::size_t i) {
  const PointPacket& p = tree.points[i / kLanes];
  return {p.x[i % kLanes], p.y[i % kLanes], p.z[i % kLanes]};
}

// Distance to a box around the origin, in closed form.
double box_distance(const Vec3& x, const Vec3& half) {
  const Vec3 q = x.cwiseAbs() - half;
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

Vec3 random_point(Random& random, double half) {
  return {random.uniform(-half, half), random.uniform(-half, half), random.uniform(-half, half)};
}

TEST(SignedDistance, IsTheClosedFormOfABox) {
  Mesh mesh = make("box", {1.0, 2.0, 0.5});
  const Vec3 center = geometry::bounding_box(mesh).center();
  const SignedDistance surface(mesh);
  Random random(3);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 x = random_point(random, 1.5);
    const ClosestPoint nearest = surface.query(center + x);
    EXPECT_NEAR(nearest.distance, box_distance(x, {0.5, 1.0, 0.25}), 1e-12);
    EXPECT_NEAR((center + x - nearest.point).norm(), std::abs(nearest.distance), 1e-12);
    EXPECT_NEAR(nearest.pseudonormal.norm(), 1.0, 1e-12);
  }
}

// Brute force over all triangles by dense sampling cannot be nearer, and the hint changes nothing.
TEST(SignedDistance, FindsNoFartherPointThanAnyVertexAndIgnoresHints) {
  const Mesh mesh = make("rock");
  const SignedDistance surface(mesh);
  Random random(4);
  for (int i = 0; i < 500; ++i) {
    const Vec3 x = random_point(random, 0.8);
    const double d = surface.query(x).distance;
    for (const geometry::Triangle& t : mesh.triangles) {
      const Vec3 c = (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.0;
      ASSERT_LE(std::abs(d), (x - c).norm() + 1e-12);
      ASSERT_LE(std::abs(d), (x - mesh.vertices[t[0]]).norm() + 1e-12);
    }
    const auto hint = random.next_u32() % static_cast<std::uint32_t>(mesh.triangles.size());
    EXPECT_EQ(surface.query(x, std::numeric_limits<double>::infinity(), hint).distance, d);
    EXPECT_EQ(surface.query(x, std::abs(d) * 1.001 + 1e-12).distance, d);
    EXPECT_FALSE(std::isfinite(surface.query(x, std::abs(d) * 0.999 - 1e-12).distance));
  }
}

// The sign is that of the winding, also in the notch of an L.
TEST(SignedDistance, IsNegativeExactlyInside) {
  const Mesh mesh = make("l");
  const SignedDistance surface(mesh);
  Random random(5);
  const Box3 box = geometry::bounding_box(mesh);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 x = box.center() + random_point(random, box.sizes().maxCoeff() * 0.6);
    bool inside = false;
    for (const geometry::Tetrahedron& t : mesh.tetrahedra) {
      Mat3 edges;
      for (int k = 0; k < 3; ++k) {
        edges.col(k) = mesh.vertices[t[static_cast<std::size_t>(k) + 1]] - mesh.vertices[t[0]];
      }
      const Vec3 w = edges.inverse() * (x - mesh.vertices[t[0]]);
      inside = inside || (w.minCoeff() >= 0.0 && w.sum() <= 1.0);
    }
    EXPECT_EQ(surface.query(x).distance < 0.0, inside) << x.transpose();
  }
}

TEST(SignedDistance, RefusesASurfaceWithoutArea) {
  Mesh mesh;
  mesh.vertices = {Vec3::Zero(), Vec3::UnitX()};
  mesh.triangles = {{0, 1, 1}};
  EXPECT_THROW(SignedDistance{mesh}, InvalidArgument);
}

class Samples : public testing::TestWithParam<std::string> {};

// They lie on the surface, share its whole area, and leave no part without a sample of its side.
TEST_P(Samples, CoverTheSurface) {
  const Mesh mesh = make(GetParam());
  const SignedDistance surface(mesh);
  const double spacing = geometry::bounding_box(mesh).sizes().maxCoeff() / 16.0;
  const std::vector<SurfaceSample> samples = sample_surface(surface, spacing);
  double total = 0.0;
  for (const SurfaceSample& s : samples) {
    EXPECT_NEAR(surface.query(s.position).distance, 0.0, 1e-9);
    EXPECT_NEAR(s.normal.norm(), 1.0, 1e-9);
    total += s.area;
  }
  double area = 0.0;
  Random random(6);
  for (std::uint32_t t = 0; t < surface.triangle_count(); ++t) {
    const auto& c = surface.corners(t);
    const Vec3 u = surface.vertex(c[1]) - surface.vertex(c[0]);
    const Vec3 v = surface.vertex(c[2]) - surface.vertex(c[0]);
    area += 0.5 * u.cross(v).norm();
    for (int k = 0; k < 10; ++k) {
      double a = random.uniform();
      double b = random.uniform();
      if (a + b > 1.0) {
        a = 1.0 - a;
        b = 1.0 - b;
      }
      const Vec3 x = surface.vertex(c[0]) + a * u + b * v;
      double nearest = 1e9;
      for (const SurfaceSample& s : samples) {
        if (s.normal.dot(surface.face_normal(t)) >= std::min(0.5, s.cone_cosine - 1e-9)) {
          nearest = std::min(nearest, (s.position - x).norm());
        }
      }
      EXPECT_LT(nearest, 1.15 * spacing);
    }
  }
  EXPECT_NEAR(total, area, 1e-9 * area);
  // About one per spacing^2: no shape needs a multiple of what its area asks for.
  const double expected = area / (spacing * spacing);
  EXPECT_LT(static_cast<double>(samples.size()), 1.6 * expected + 20.0);
  EXPECT_GT(static_cast<double>(samples.size()), 0.5 * expected);
}
INSTANTIATE_TEST_SUITE_P(Shapes, Samples,
                         testing::Values("cube", "sphere", "hexapod", "torus", "l", "rock"));

TEST(SurfaceSamples, KeepCornersAndEdgesOfACubeWithTheirNormalCones) {
  const Mesh mesh = make("cube");
  const Vec3 center = geometry::bounding_box(mesh).center();
  const std::vector<SurfaceSample> samples = sample_surface(SignedDistance(mesh), 1.0 / 8.0);
  int corners = 0;
  int edges = 0;
  for (const SurfaceSample& s : samples) {
    const Vec3 from_center = (s.position - center).cwiseAbs();
    const auto extreme = (from_center.array() > 0.5 - 1e-9).count();
    if (s.kind == SampleKind::corner) {
      ++corners;
      EXPECT_EQ(extreme, 3);
      EXPECT_NEAR(s.cone_cosine, 1.0 / std::numbers::sqrt3, 1e-9);
    } else if (s.kind == SampleKind::edge) {
      ++edges;
      EXPECT_EQ(extreme, 2);
      EXPECT_NEAR(s.cone_cosine, std::numbers::sqrt2 / 2.0, 1e-9);
      EXPECT_NEAR(s.edge_direction.dot(s.normal), 0.0, 1e-9);
      EXPECT_LE(s.reach_back + s.reach_forward, 2.0 / 8.0 + 1e-9);
    } else {
      EXPECT_EQ(extreme, 1);
      EXPECT_NEAR(s.cone_cosine, 1.0, 1e-9);
    }
  }
  EXPECT_EQ(corners, 8);
  EXPECT_GE(edges, 12 * 6);
  EXPECT_LE(edges, 12 * 9);
}

TEST(SurfaceSamples, KeepBothSidesOfAThinPlate) {
  const std::vector<SurfaceSample> samples =
      sample_surface(SignedDistance(make("box", {1.0, 1.0, 0.01})), 1.0 / 16.0);
  double up = 0.0;
  double down = 0.0;
  for (const SurfaceSample& s : samples) {
    if (s.normal.z() > 0.9) up += s.area;
    if (s.normal.z() < -0.9) down += s.area;
  }
  EXPECT_GT(up, 0.8);
  EXPECT_GT(down, 0.8);
}

TEST(SurfaceTree, BoundsEverySampleAtEveryHeight) {
  const SurfaceModel model = make_surface_model(make("hexapod"), 5);
  const SurfaceTree& tree = model.tree;
  ASSERT_EQ(tree.heights.back().size(), 1U);
  std::size_t run = kLanes;
  for (const auto& packets : tree.heights) {
    std::size_t lanes = 0;
    for (const SpherePacket& p : packets) {
      lanes += static_cast<std::size_t>(
          std::count_if(p.radius.begin(), p.radius.end(), [](float r) { return r >= 0.0F; }));
    }
    EXPECT_EQ(lanes, (tree.size() + run - 1) / run);
    for (std::size_t i = 0; i < tree.size(); ++i) {
      const std::size_t child = i / run;
      const SpherePacket& p = packets[child / kLanes];
      const std::size_t lane = child % kLanes;
      EXPECT_LE((point_of(tree, i) - Vec3(p.x[lane], p.y[lane], p.z[lane])).norm(),
                static_cast<double>(p.radius[lane]));
    }
    run *= kLanes;
  }
}

TEST(SurfaceTree, KeepsWhatSamplesAreBesidesPoints) {
  for (const char* name : {"hexapod", "rock", "sphere"}) {
    const Mesh mesh = make(name);
    const std::vector<SurfaceSample> samples =
        sample_surface(SignedDistance(mesh), name == std::string("sphere") ? 0.25 : 0.04);
    const SurfaceTree tree = make_surface_tree(samples, Vec3(0.1, 0.2, 0.3));
    ASSERT_EQ(tree.size(), samples.size());
    std::size_t vertices = 0;
    for (std::uint32_t i = 0; i < tree.size(); ++i) {
      const Vec3 x = point_of(tree, i) + Vec3(0.1, 0.2, 0.3);
      const SurfaceSample& s = *std::min_element(
          samples.begin(), samples.end(), [&](const SurfaceSample& a, const SurfaceSample& b) {
            return (a.position - x).squaredNorm() < (b.position - x).squaredNorm();
          });
      ASSERT_LT((s.position - x).norm(), 1e-6);
      const auto to_double = [](const std::array<float, 3>& v) { return Vec3(v[0], v[1], v[2]); };
      const Vec3 normal = to_double(unit_normal(tree.elements[i]));
      EXPECT_LT((normal - s.normal).norm(), 3e-5);
      EXPECT_NEAR(normal.norm(), 1.0, 2e-7);
      EXPECT_LT((to_double(tree.vector_area(i)) - s.vector_area).cwiseAbs().maxCoeff(),
                0.51 * static_cast<double>(tree.area_unit));
      EXPECT_EQ(tree.elements[i].cone_cosine, static_cast<float>(s.cone_cosine));
      const SampleEdge* edge = tree.edge_of(i);
      ASSERT_EQ(edge != nullptr, s.kind == SampleKind::edge);
      if (edge != nullptr) {
        EXPECT_LT((to_double(edge->direction) - s.edge_direction).norm(), 1e-6);
        EXPECT_EQ(edge->back, static_cast<float>(s.reach_back));
        EXPECT_EQ(edge->forward, static_cast<float>(s.reach_forward));
      }
      ASSERT_EQ(tree.vertices_of(i).size(), s.vertices.size());
      EXPECT_EQ(tree.has_vertices(i), !s.vertices.empty());
      for (std::size_t v = 0; v < s.vertices.size(); ++v) {
        EXPECT_LT((to_double(tree.vertices_of(i)[v]) + Vec3(0.1, 0.2, 0.3) - s.vertices[v]).norm(),
                  1e-6);
      }
      vertices += s.vertices.size();
    }
    EXPECT_EQ(tree.vertices.size(), vertices);
    if (name == std::string("sphere")) {
      EXPECT_GT(vertices, 20U);
    }
    if (name == std::string("hexapod")) {
      EXPECT_GT(tree.edges.size(), 100U);
    }
  }
}

// Leaf spheres of eight samples stay near the size of the patch that eight samples cover.
TEST(SurfaceTree, KeepsLeavesCompact) {
  const SurfaceModel model = make_surface_model(make("sphere"), 5);
  double sum = 0.0;
  int count = 0;
  for (const SpherePacket& p : model.tree.heights[0]) {
    for (const float r : p.radius) {
      if (r < 0.0F) continue;
      sum += static_cast<double>(r);
      ++count;
    }
  }
  EXPECT_LT(sum / count, 2.2 * model.spacing);
}

TEST(DistanceField, InterpolatesABoxExactlyOnItsFacesAndWithinTheBoundEverywhere) {
  const Mesh mesh = make("cube");
  const Vec3 center = geometry::bounding_box(mesh).center();
  const DistanceField field = make_distance_field(SignedDistance(mesh), center, 1.0, 6);
  const double cell = static_cast<double>(field.cell);
  Random random(8);
  int in_band = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 x = random_point(random, 0.9);
    const double exact = box_distance(x, Vec3::Constant(0.5));
    const FieldValue value = evaluate(field, x);
    in_band += value.in_band ? 1 : 0;
    if (std::abs(exact) < static_cast<double>(field.band) && x.cwiseAbs().maxCoeff() < 0.55) {
      EXPECT_TRUE(value.in_band);
    }
    // Interpolation of a 1-Lipschitz function errs by less than half a cell's diagonal.
    const double step = value.in_band ? cell : kCoarseCells * cell;
    const double outside = (x.cwiseAbs().array() - cell * field.cells() * 0.5).maxCoeff();
    EXPECT_NEAR(value.distance, exact, 0.867 * step + std::max(0.0, 1.0 * outside));
    if ((x.cwiseAbs().array() < 0.3).count() == 2 && value.in_band) {
      EXPECT_NEAR(value.distance, exact, 1e-3 * cell);
      EXPECT_NEAR(value.gradient.norm(), 1.0, 1e-3);
    }
  }
  EXPECT_GT(in_band, 500);
}

// The bound that pruning relies on: within bricks, values change by at most slope * distance.
TEST(DistanceField, IsAsSteepAsItSays) {
  const SurfaceModel model = make_surface_model(make("hexapod"), 5);
  Random random(9);
  double steepest = 0.0;
  for (std::size_t i = 0; i < model.tree.size(); ++i) {
    for (int k = 0; k < 20; ++k) {
      const Vec3 x = point_of(model.tree, i) + random_point(random, model.spacing);
      const Vec3 y = x + random_point(random, 0.02 * model.spacing);
      const FieldValue a = evaluate(model.field, x);
      const FieldValue b = evaluate(model.field, y);
      if (!a.in_band || !b.in_band) continue;
      steepest = std::max(steepest, std::abs(a.distance - b.distance) / (x - y).norm());
      EXPECT_LE(std::abs(a.distance - b.distance),
                static_cast<double>(model.field.slope) * (x - y).norm() + 1e-9);
    }
  }
  EXPECT_GT(steepest, 0.9);
}

// On a smooth surface the error of the interpolated distance is of second order in the cell.
TEST(DistanceField, ConvergesWithSecondOrderOnASphere) {
  geometry::GeneratorOptions options;
  options.shape = "sphere";
  options.subdivisions = 24;
  const Mesh mesh = geometry::generate(options);
  const SignedDistance surface(mesh);
  const Box3 box = geometry::bounding_box(mesh);
  std::vector<double> rms;
  for (const int level : {4, 5, 6}) {
    const DistanceField field =
        make_distance_field(surface, box.center(), box.sizes().maxCoeff(), level);
    Random random(10);
    double sum = 0.0;
    const int count = 2000;
    for (int i = 0; i < count; ++i) {
      const Vec3 x = random.unit_vector() * random.uniform(0.49, 0.51);
      const double error = evaluate(field, x).distance - surface.query(box.center() + x).distance;
      sum += error * error;
    }
    rms.push_back(std::sqrt(sum / count));
  }
  EXPECT_GT(std::log2(rms[0] / rms[1]), 1.7);
  EXPECT_GT(std::log2(rms[1] / rms[2]), 1.7);
}

TEST(SurfaceModel, StaysSmallAndIsTheSameEveryTime) {
  const Mesh mesh = make("hexapod");
  const SurfaceModel model = make_surface_model(mesh, 6);
  EXPECT_LE(model.bytes(), 400U * 1024U) << model.tree.bytes() << " + " << model.field.bytes();
  const SurfaceModel again = make_surface_model(mesh, 6);
  EXPECT_EQ(model.field.values, again.field.values);
  EXPECT_EQ(model.field.coarse, again.field.coarse);
  ASSERT_EQ(model.tree.size(), again.tree.size());
  for (std::uint32_t i = 0; i < model.tree.size(); ++i) {
    EXPECT_EQ(model.tree.vector_area(i), again.tree.vector_area(i));
    EXPECT_EQ(model.tree.elements[i].normal, again.tree.elements[i].normal);
    EXPECT_EQ(model.tree.elements[i].cone_cosine, again.tree.elements[i].cone_cosine);
  }
}

// The level follows from the thinnest walls and from the accuracy that is wished for.
TEST(SurfaceModel, LevelFollowsFromWallsAndAccuracy) {
  // A plate of 0.02 m is a voxel thick at level 7 (1/64 m), not at level 6.
  const Mesh plate = make("box", {1.0, 1.0, 0.02});
  EXPECT_EQ(make_surface_model(plate, 4).level, 4);
  EXPECT_EQ(make_surface_model(plate, 4, 0.1).level, 7);
  const Mesh cube = make("cube");
  EXPECT_EQ(make_surface_model(cube, 4, 0.1).level, 4);
  // The wish is kept, by a measure of its own: exact distances at points near the surface.
  const Mesh ball = make("sphere");
  int coarser = 0;
  for (const double wish : {1e-2, 1e-3, 2e-4}) {
    const SurfaceModel model = make_surface_model(ball, 3, wish);
    EXPECT_GT(model.level, coarser);
    coarser = model.level;
    const SignedDistance surface(ball);
    Random random(8);
    double sum = 0.0;
    for (int i = 0; i < 500; ++i) {
      const Vec3 x = model.center + random.uniform(0.48, 0.52) * random.unit_vector();
      sum +=
          std::pow(evaluate(model.field, x - model.center).distance - surface.query(x).distance, 2);
    }
    EXPECT_LE(std::sqrt(sum / 500), 1.2 * wish);
  }
  // What no level can do is not done for ever.
  EXPECT_EQ(make_surface_model(make("hexapod"), 5, 1e-9).level, kMaxSurfaceLevel);
  EXPECT_THROW(make_surface_model(cube, 4, -1.0), InvalidArgument);
}

TEST(SurfaceModel, RefusesLevelsOutOfRange) {
  const Mesh mesh = make("cube");
  EXPECT_THROW(make_surface_model(mesh, kMinSurfaceLevel - 1), InvalidArgument);
  EXPECT_THROW(make_surface_model(mesh, kMaxSurfaceLevel + 1), InvalidArgument);
}

}  // namespace
}  // namespace gotai::voxel
