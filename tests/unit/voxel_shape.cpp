#include "gotai/voxel/shape.h"

#include <gmock/gmock.h>

#include <cmath>

#include "gotai/core/error.h"
#include "gotai/core/parallel.h"
#include "gotai/core/random.h"
#include "gotai/geometry/generate.h"
#include "gotai/voxel/inside.h"

namespace gotai::voxel {
namespace {

using geometry::GeneratorOptions;
using geometry::Mesh;
using testing::HasSubstr;
using testing::ThrowsMessage;

Mesh without_tetrahedra(Mesh mesh) {
  mesh.tetrahedra.clear();
  return mesh;
}

Mesh box(const Vec3& extents) {
  GeneratorOptions options;
  options.shape = "box";
  options.extents = extents;
  return geometry::generate(options);
}

Mesh moved(Mesh mesh, const Quat& q, const Vec3& p) {
  for (Vec3& v : mesh.vertices) v = q * v + p;
  return mesh;
}

Mesh joined(Mesh a, const Mesh& b) {
  const auto offset = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const geometry::Triangle& t : b.triangles)
    a.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  return a;
}

Mesh inside_out(Mesh mesh) {
  for (geometry::Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

class EveryGenerator : public testing::TestWithParam<std::string> {
 protected:
  static Mesh mesh() {
    GeneratorOptions options;
    options.shape = GetParam();
    return geometry::generate(options);
  }
};

// Two independent ways to the same set: the union of closed tetrahedra, and the winding of their
// boundary. Axis-aligned shapes have thousands of centres exactly on faces.
TEST_P(EveryGenerator, SurfaceAndTetrahedraHoldTheSameVoxels) {
  Random random(7);
  for (const bool turned : {false, true}) {
    const Mesh shape = turned ? moved(mesh(), random.rotation(), Vec3(0.3, -20.0, 0.1)) : mesh();
    ASSERT_TRUE(has_closed_surface(shape));
    const VoxelGrid grid = grid_around(geometry::bounding_box(shape));
    for (const int level : {1, 2, 3, 5, 7})
      EXPECT_EQ(voxels_in_tetrahedra(shape, grid, level),
                voxels_in_closed_surface(shape, grid, level))
          << "level " << level;
  }
}

TEST_P(EveryGenerator, VoxelVolumeIsNearTheExactOne) {
  const Mesh shape = without_tetrahedra(mesh());
  const double volume = geometry::mass_properties(shape).volume;
  const VoxelGrid grid = grid_around(geometry::bounding_box(shape));
  const double cell = std::pow(grid.voxel_edge(7), 3);
  const VoxelSet inside = voxels_in_closed_surface(shape, grid, 7);
  // Only voxels at the surface can be wrong, by half of each where the surface has no preference.
  EXPECT_NEAR(static_cast<double>(inside.count()) * cell, volume,
              0.5 * static_cast<double>(inside.surface().count()) * cell);
}

INSTANTIATE_TEST_SUITE_P(Shapes, EveryGenerator, testing::ValuesIn(geometry::generator_names()),
                         [](const auto& param_info) { return param_info.param; });

TEST(ClosedSurface, CentersExactlyOnAFaceAreInside) {
  // Two parallel faces at the height of voxel centres of level 4 (0.0625 + i / 8): with <= for one
  // side and < for the other the plate would have one layer.
  const Mesh plate = without_tetrahedra(box(Vec3(1.0, 1.0, 0.125)));
  const VoxelGrid grid = grid_around(geometry::bounding_box(plate));
  EXPECT_EQ(voxels_in_closed_surface(plate, grid, 4).count(), 2U * 64U);
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 extents = Vec3::Ones();
    extents[axis] = 0.125;
    const Mesh turned = without_tetrahedra(box(extents));
    EXPECT_EQ(voxels_in_closed_surface(turned, grid, 4).count(), 2U * 64U);
  }
}

TEST(ClosedSurface, OverlappingPartsAreOneBodyAndCavitiesAreEmpty) {
  const Mesh cube = without_tetrahedra(box(Vec3::Ones()));
  const Mesh shifted = moved(cube, Quat::Identity(), Vec3(0.5, 0.0, 0.0));
  const VoxelGrid grid{Vec3(-0.5, -0.75, -0.75), 1.5};
  const double cell = std::pow(grid.voxel_edge(6), 3);
  const auto volume = [&](const Mesh& mesh) {
    return static_cast<double>(voxels_in_closed_surface(mesh, grid, 6).count()) * cell;
  };
  EXPECT_NEAR(volume(joined(cube, shifted)), 1.5, 0.1);
  const Mesh core = without_tetrahedra(box(Vec3::Constant(0.5)));
  EXPECT_NEAR(volume(joined(cube, inside_out(core))), 0.875, 0.1);
}

TEST(ClosedSurface, IsToldFromAnOpenOne) {
  Mesh cube = without_tetrahedra(box(Vec3::Ones()));
  EXPECT_TRUE(has_closed_surface(cube));
  EXPECT_TRUE(has_closed_surface(inside_out(cube)));
  Mesh hole = cube;
  hole.triangles.pop_back();
  EXPECT_FALSE(has_closed_surface(hole));
  Mesh flipped = cube;
  std::swap(flipped.triangles[3][0], flipped.triangles[3][1]);
  EXPECT_FALSE(has_closed_surface(flipped));
  Mesh split;  // every triangle with vertices of its own
  for (const geometry::Triangle& t : cube.triangles)
    for (const std::uint32_t v : t) {
      if (split.vertices.size() % 3 == 0) {
        const auto n = static_cast<std::uint32_t>(split.vertices.size());
        split.triangles.push_back({n, n + 1, n + 2});
      }
      split.vertices.push_back(cube.vertices[v]);
    }
  EXPECT_TRUE(has_closed_surface(split));
  EXPECT_FALSE(has_closed_surface(Mesh()));
}

TEST(ClosedSurface, IsTheSameForEveryNumberOfThreads) {
  GeneratorOptions options;
  options.shape = "rock";
  const Mesh rock = geometry::generate(options);
  const VoxelGrid grid = grid_around(geometry::bounding_box(rock));
  const auto voxels = [&](int threads) {
    const ThreadLimit limit(threads);
    return voxels_in_closed_surface(rock, grid, 7);
  };
  EXPECT_EQ(voxels(1), voxels(2));
}

TEST(Shape, HoldsWhatABodyNeeds) {
  const Shape shape = make_shape("block", box(Vec3(2.0, 1.0, 1.0)), {.prepared_level = 5});
  EXPECT_EQ(shape.name, "block");
  EXPECT_EQ(shape.pyramid.max_level(), 5);
  EXPECT_DOUBLE_EQ(shape.mass.volume, 2.0);
  EXPECT_DOUBLE_EQ(shape.bounding_radius, std::sqrt(1.5));
  // Level 1 is one cube of edge 2 around the same centre.
  EXPECT_DOUBLE_EQ(shape.voxel_bounding_radius.at(0), std::sqrt(3.0));
  ASSERT_EQ(shape.voxel_bounding_radius.size(), 5U);
  // Level 5: the corner voxel's centre is half a voxel (1/8) inside, and its sphere reaches the
  // corner exactly.
  EXPECT_NEAR(shape.voxel_bounding_radius.at(4),
              Vec3(1.0 - 0.0625, 0.5 - 0.0625, 0.5 - 0.0625).norm() + std::sqrt(3.0) / 16.0, 1e-15);
  for (int h = 1; h <= 5; ++h)
    for (const Vec3& c : shape.pyramid.level(h).center)
      EXPECT_LE((c - shape.mass.center_of_mass).norm() + shape.pyramid.grid.voxel_radius(h),
                shape.voxel_bounding_radius.at(static_cast<std::size_t>(h) - 1));
}

TEST(Shape, ContentHashSeesMeshAndOptions) {
  const Mesh mesh = box(Vec3::Ones());
  const Hash128 hash = content_hash(mesh, {});
  EXPECT_EQ(hash, content_hash(mesh, {}));
  EXPECT_EQ(hash, make_shape("any name", mesh, {}).content);
  EXPECT_FALSE(hash == content_hash(mesh, {.prepared_level = 6}));
  Mesh other = mesh;
  other.vertices[0].x() = std::nextafter(other.vertices[0].x(), 2.0);
  EXPECT_FALSE(hash == content_hash(other, {}));
  EXPECT_FALSE(hash == content_hash(without_tetrahedra(mesh), {}));
}

TEST(Shape, TooThinABodySaysWhichLevelWouldDo) {
  // 1 cm of 1 m: the centres next to the middle plane are half a voxel away, 1/128 at level 7.
  const Mesh plate = box(Vec3(1.0, 1.0, 0.01));
  EXPECT_THAT([&] { make_shape("plate", plate, {.prepared_level = 7}); },
              ThrowsMessage<InvalidArgument>(HasSubstr("use level 8")));
  EXPECT_NO_THROW(make_shape("plate", plate, {.prepared_level = 8}));
  EXPECT_THAT([&] { make_shape("foil", box(Vec3(1.0, 1.0, 1e-4)), {.prepared_level = 7}); },
              ThrowsMessage<InvalidArgument>(HasSubstr("make the body thicker")));
}

TEST(Shape, RefusesWhatIsNoBody) {
  const Mesh cube = box(Vec3::Ones());
  for (const int level : {-1, 0, kMaxLevel + 1})
    EXPECT_THAT([&] { make_shape("cube", cube, {.prepared_level = level}); },
                ThrowsMessage<InvalidArgument>(HasSubstr("must be 1..9")));
  Mesh open = without_tetrahedra(cube);
  open.triangles.pop_back();
  EXPECT_THAT([&] { make_shape("open", open, {}); },
              ThrowsMessage<InvalidArgument>(HasSubstr("not closed")));
  Mesh bad = cube;
  bad.tetrahedra[2][1] = 1000;
  EXPECT_THAT([&] { make_shape("bad", bad, {}); },
              ThrowsMessage<InvalidArgument>(HasSubstr("vertex 1000 in tetrahedron 2")));
  bad = cube;
  bad.vertices[3].y() = std::nan("");
  EXPECT_THAT([&] { make_shape("bad", bad, {}); },
              ThrowsMessage<InvalidArgument>(HasSubstr("vertex 3")));
  EXPECT_THROW(make_shape("empty", Mesh(), {}), InvalidArgument);
}

}  // namespace
}  // namespace gotai::voxel
