#include "gotai/voxel/shape.h"

#include <gmock/gmock.h>

#include <cmath>

#include "gotai/core/error.h"
#include "gotai/core/parallel.h"
#include "gotai/core/random.h"
#include "gotai/geometry/generate.h"
#include "gotai/voxel/inside.h"
#include "gotai/voxel/inside_soup.h"
#include "support/mesh_text.h"

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
    for (const Vec3& c : shape.pyramid.voxel_centers(h))
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
  for (const double thickness : {-1.0, std::nan(""), HUGE_VAL})
    EXPECT_THAT([&] { make_shape("cube", cube, {.thickness = thickness}); },
                ThrowsMessage<InvalidArgument>(HasSubstr("must be 0 (none) or positive")));
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

/// The triangles whose centre is below a height.
Mesh below(const Mesh& mesh, double height) {
  Mesh result;
  result.vertices = mesh.vertices;
  for (const geometry::Triangle& t : mesh.triangles)
    if ((mesh.vertices[t[0]].z() + mesh.vertices[t[1]].z() + mesh.vertices[t[2]].z()) / 3.0 <
        height)
      result.triangles.push_back(t);
  return result;
}

TEST(ImperfectShape, MassComesFromTheVoxelsWithItsError) {
  const Mesh rock = test::generated_surface("rock", 4);
  const Shape exact = make_shape("rock", rock, {});
  EXPECT_EQ(exact.volume_error, 0.0);
  EXPECT_TRUE(exact.warnings.empty());
  Mesh damaged = rock;
  for (std::size_t t = 0; t < damaged.triangles.size(); t += 9)
    std::swap(damaged.triangles[t][0], damaged.triangles[t][1]);
  for (std::size_t t = 100; t < 130; ++t) damaged.triangles.pop_back();
  const Shape shape = make_shape("rock", damaged, {});
  EXPECT_GT(shape.volume_error, 0.0);
  EXPECT_LT(shape.volume_error, 0.05);
  EXPECT_THAT(shape.warnings, testing::Contains(HasSubstr("not closed")));
  EXPECT_THAT(shape.warnings, testing::Contains(HasSubstr("faced the wrong way")));
  EXPECT_THAT(shape.warnings, testing::Contains(HasSubstr("counted in voxels of level 7")));
  // Far better than the stated bound: the errors of the surface voxels cancel.
  EXPECT_NEAR(shape.mass.volume, exact.mass.volume, 0.005 * exact.mass.volume);
  EXPECT_LT((shape.mass.center_of_mass - exact.mass.center_of_mass).norm(), 0.003);
  EXPECT_LT((shape.mass.inertia - exact.mass.inertia).norm(), 0.01 * exact.mass.inertia.norm());
}

TEST(ImperfectShape, VoxelMassOfABoxIsExact) {
  const VoxelGrid grid{Vec3(10.0, -3.0, 2.0), 4.0};
  VoxelSet block(5);  // 3 x 2 x 1 m
  for (int iz = 0; iz < 4; ++iz)
    for (int iy = 0; iy < 8; ++iy) block.insert_run(2, 13, iy, iz);
  const geometry::MassProperties mass = voxel_mass(block, grid);
  EXPECT_DOUBLE_EQ(mass.volume, 6.0);
  EXPECT_LT((mass.center_of_mass - Vec3(12.0, -2.0, 2.5)).norm(), 1e-13);
  const Vec3 inertia(6.0 / 12 * (4 + 1), 6.0 / 12 * (9 + 1), 6.0 / 12 * (9 + 4));
  EXPECT_LT((mass.inertia - Mat3(inertia.asDiagonal())).norm(), 1e-12);
}

TEST(ImperfectShape, DistanceFieldHasTheSignOfTheSolid) {
  Mesh damaged = test::generated_surface("sphere", 12);
  for (std::size_t t = 0; t < damaged.triangles.size(); t += 7)
    std::swap(damaged.triangles[t][0], damaged.triangles[t][1]);
  std::erase_if(damaged.triangles,
                [&](const geometry::Triangle& t) { return damaged.vertices[t[0]].z() > 0.45; });
  const Shape shape = make_shape("ball", damaged, {.prepared_level = 6, .surface_level = 5});
  Random random(5);
  for (int i = 0; i < 500; ++i) {
    const Vec3 x = 0.6 * random.uniform() * random.unit_vector();
    if (std::abs(x.norm() - 0.5) < 0.03 || x.z() > 0.4) continue;
    EXPECT_EQ(evaluate(shape.surface.field, x - shape.surface.center).distance < 0.0,
              x.norm() < 0.5)
        << x.transpose();
  }
}

TEST(ImperfectShape, OverlappingPartsCountOnce) {
  const Mesh cube = without_tetrahedra(box(Vec3::Ones()));
  const Mesh two = joined(cube, moved(cube, Quat::Identity(), Vec3(0.5, 0.0, 0.0)));
  const Shape shape = make_shape("two", two, {.prepared_level = 6});
  EXPECT_THAT(shape.warnings, testing::Contains(HasSubstr("overlap")));
  EXPECT_NEAR(shape.mass.volume, 1.5, 0.1);
  // Parts that only touch are exact.
  const Mesh beside = joined(cube, moved(cube, Quat::Identity(), Vec3(1.0, 0.0, 0.0)));
  EXPECT_EQ(make_shape("beside", beside, {.prepared_level = 6}).volume_error, 0.0);
}

TEST(ImperfectShape, DoubledFacesCountOnce) {
  const Mesh cube = without_tetrahedra(box(Vec3::Ones()));
  for (const Mesh& copy : {cube, inside_out(cube)}) {
    Mesh doubled = cube;
    doubled.triangles.insert(doubled.triangles.end(), copy.triangles.begin(), copy.triangles.end());
    const Shape shape = make_shape("doubled", doubled, {.prepared_level = 5});
    EXPECT_NEAR(shape.mass.volume, 1.0, 0.01);
    EXPECT_FALSE(shape.warnings.empty());
  }
}

TEST(ImperfectShape, InsideOutIsTurned) {
  const Mesh cube = inside_out(without_tetrahedra(box(Vec3::Ones())));
  const Shape shape = make_shape("cube", cube, {.prepared_level = 5});
  EXPECT_DOUBLE_EQ(shape.mass.volume, 1.0);
  EXPECT_EQ(shape.volume_error, 0.0);
}

TEST(ImperfectShape, OpenSurfacesAreRefusedUnlessTheyGetAThickness) {
  const Mesh ball = test::generated_surface("sphere", 16);
  const Mesh bucket = below(test::generated_surface("cylinder", 16), 0.49);
  Mesh sheet;
  sheet.vertices = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  Mesh two_sided = sheet;
  two_sided.triangles.push_back({0, 2, 1});
  two_sided.triangles.push_back({0, 3, 2});
  for (const Mesh& open : {sheet, two_sided, bucket, below(ball, 0.0)}) {
    EXPECT_THAT([&] { make_shape("open", open, {}); },
                ThrowsMessage<InvalidArgument>(HasSubstr("give the thickness of the sheet")));
    const Shape shape = make_shape("open", open, {.thickness = 0.05});
    EXPECT_EQ(shape.volume_error, 0.0);
    EXPECT_TRUE(has_closed_surface(shape.mesh));
  }
  EXPECT_DOUBLE_EQ(make_shape("sheet", sheet, {.thickness = 0.05}).mass.volume, 0.05);
  // A ball's surface becomes a shell: 4 pi r^2 t and a little more.
  const double shell = make_shape("shell", ball, {.thickness = 0.05}).mass.volume;
  EXPECT_NEAR(shell, M_PI * 0.05, 0.01 * M_PI * 0.05);
  // A small opening does not make a sheet of it.
  EXPECT_NO_THROW(make_shape("ball", below(ball, 0.45), {}));
}

TEST(ImperfectShape, OneSidedSheetsGetAThicknessToo) {
  Mesh moebius;
  const int n = 60;
  for (int i = 0; i < n; ++i) {
    const double angle = 2.0 * M_PI * i / n;
    const Vec3 ring(std::cos(angle), std::sin(angle), 0.0);
    const Vec3 across = std::cos(0.5 * angle) * ring + std::sin(0.5 * angle) * Vec3::UnitZ();
    moebius.vertices.push_back(ring - 0.3 * across);
    moebius.vertices.push_back(ring + 0.3 * across);
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t a = 2 * i;
    const bool last = i + 1 == n;
    const std::uint32_t b = last ? 1 : a + 2;
    const std::uint32_t c = last ? 0 : a + 3;
    moebius.triangles.push_back({a, a + 1, c});
    moebius.triangles.push_back({a, c, b});
  }
  EXPECT_THROW(make_shape("moebius", moebius, {}), InvalidArgument);
  const Shape shape = make_shape("moebius", moebius, {.thickness = 0.1});
  EXPECT_TRUE(has_closed_surface(shape.mesh));
  EXPECT_NEAR(shape.mass.volume, 2.0 * M_PI * 0.6 * 0.1, 0.1 * 2.0 * M_PI * 0.6 * 0.1);
}

}  // namespace
}  // namespace gotai::voxel
