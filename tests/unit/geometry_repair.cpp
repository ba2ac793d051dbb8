#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "gotai/core/error.h"
#include "gotai/core/random.h"
#include "gotai/geometry/generate.h"
#include "gotai/geometry/mesh_report.h"
#include "gotai/geometry/tetrahedra.h"

namespace gotai::geometry {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Mesh surface_of(const GeneratorOptions& options) {
  Mesh mesh = generate(options);
  mesh.tetrahedra.clear();
  weld(mesh);
  return mesh;
}

void reverse(Triangle& t) { std::swap(t[1], t[2]); }

/// `other` may be the mesh itself.
void append(Mesh& mesh, const Mesh& other, const Vec3& offset) {
  const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
  const std::vector<Triangle> triangles = other.triangles;
  const std::vector<Vec3> vertices = other.vertices;
  for (const Vec3& v : vertices) mesh.vertices.push_back(v + offset);
  for (const Triangle& t : triangles)
    mesh.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
}

MeshReport repaired(Mesh& mesh) {
  MeshReport counts;
  repair(mesh, counts);
  MeshReport report = inspect(mesh);
  report.repairs = counts.repairs;
  report.warnings = counts.warnings;
  report.duplicate_triangles = counts.duplicate_triangles;
  report.degenerate_triangles = counts.degenerate_triangles;
  report.inverted_tetrahedra = counts.inverted_tetrahedra;
  return report;
}

TEST(Inspect, CleanMesh) {
  const Mesh mesh = surface_of({.shape = "torus"});
  const MeshReport report = inspect(mesh);
  EXPECT_TRUE(report.closed && report.oriented && report.balanced && report.is_solid());
  EXPECT_EQ(report.components, 1U);
  EXPECT_EQ(report.boundary_edges + report.non_manifold_edges + report.misoriented_edges, 0U);
}

TEST(Inspect, AHoleIsThreeBoundaryEdges) {
  Mesh mesh = surface_of({.shape = "sphere"});
  mesh.triangles.pop_back();
  const MeshReport report = inspect(mesh);
  EXPECT_FALSE(report.closed);
  EXPECT_TRUE(report.oriented);
  EXPECT_FALSE(report.is_solid());
  EXPECT_EQ(report.boundary_edges, 3U);
}

TEST(Inspect, AReversedTriangleDisagreesWithThreeNeighbours) {
  Mesh mesh = surface_of({.shape = "sphere"});
  reverse(mesh.triangles[10]);
  const MeshReport report = inspect(mesh);
  EXPECT_TRUE(report.closed);
  EXPECT_FALSE(report.oriented);
  EXPECT_EQ(report.misoriented_edges, 3U);
}

TEST(Inspect, TwoCubesThatShareAnEdgeAreBalancedButNotClosed) {
  Mesh mesh = surface_of({.shape = "cube"});
  append(mesh, mesh, {1, 1, 0});
  weld(mesh);
  const MeshReport report = inspect(mesh);
  EXPECT_FALSE(report.closed);
  EXPECT_TRUE(report.balanced);
  EXPECT_EQ(report.non_manifold_edges, 1U);
  EXPECT_EQ(report.components, 1U);
  EXPECT_NEAR(report.volume, 2.0, 1e-14);
}

TEST(Validate, NamesTheElement) {
  Mesh mesh = surface_of({.shape = "cube"});
  mesh.triangles[3][1] = 99;
  EXPECT_THROW(validate(mesh), InvalidArgument);
  mesh = surface_of({.shape = "cube"});
  mesh.vertices[2].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(validate(mesh), InvalidArgument);
}

TEST(Weld, EqualPositionsOnlyAndZerosAreEqual) {
  Mesh mesh;
  mesh.vertices = {{9, 9, 9}, {0.0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, 0, 0}, {1, 1e-300, 0}};
  mesh.triangles = {{1, 2, 3}, {4, 3, 5}};
  EXPECT_EQ(weld(mesh), 1U);
  EXPECT_EQ(mesh.vertices.size(), 4U);
  EXPECT_EQ(mesh.triangles[1], (Triangle{0, 2, 3}));
}

TEST(Repair, ReversedTrianglesOfAClosedSurface) {
  Mesh mesh = surface_of({.shape = "torus"});
  const double volume = inspect(mesh).volume;
  Random random(3);
  for (Triangle& t : mesh.triangles)
    if (random.uniform() < 0.3) reverse(t);
  const MeshReport report = repaired(mesh);
  EXPECT_TRUE(report.oriented);
  EXPECT_NEAR(report.volume, volume, 1e-15);
  EXPECT_THAT(report.repairs, Contains(HasSubstr("disagreed")));
}

TEST(Repair, InsideOut) {
  Mesh mesh = surface_of({.shape = "hexapod"});
  for (Triangle& t : mesh.triangles) reverse(t);
  const MeshReport report = repaired(mesh);
  EXPECT_GT(report.volume, 1.0);
  EXPECT_THAT(report.repairs, Contains(HasSubstr("inside out")));
}

/// A hollow cube: outer edge 3, cavity of edge 1.
Mesh hollow_cube(bool outer_outward, bool cavity_inward) {
  Mesh mesh = surface_of({.shape = "cube", .size = 3.0});
  if (!outer_outward) std::ranges::for_each(mesh.triangles, reverse);
  Mesh cavity = surface_of({.shape = "cube"});
  if (cavity_inward) std::ranges::for_each(cavity.triangles, reverse);
  append(mesh, cavity, {0.25, 0.0, 0.0});
  return mesh;
}

TEST(Repair, CavitiesStayHollow) {
  Mesh right = hollow_cube(true, true);
  const MeshReport untouched = repaired(right);
  EXPECT_NEAR(untouched.volume, 26.0, 1e-13);
  EXPECT_THAT(untouched.repairs, IsEmpty());
  Mesh all_reversed = hollow_cube(false, false);
  EXPECT_NEAR(repaired(all_reversed).volume, 26.0, 1e-13);
  Mesh outer_reversed = hollow_cube(false, true);
  EXPECT_NEAR(repaired(outer_reversed).volume, 26.0, 1e-13);
  Mesh overlap = hollow_cube(true, false);  // a part inside another: as the file says
  EXPECT_NEAR(repaired(overlap).volume, 28.0, 1e-13);
}

TEST(Repair, ManyNestedPiecesTakeBoundedTime) {
  Mesh mesh;
  for (int i = 0; i < 300; ++i)
    append(mesh, surface_of({.shape = "sphere", .size = 1.0 + 0.01 * i}), Vec3::Zero());
  MeshReport counts;
  repair(mesh, counts);
  EXPECT_THAT(counts.warnings, Contains(HasSubstr("not checked for being inside out")));
}

/// Two boxes of which each brings its own copy of the wall between them.
TEST(Repair, WallsBetweenTouchingPartsDisappear) {
  Mesh mesh = surface_of({.shape = "cube"});
  append(mesh, surface_of({.shape = "cube"}), {1, 0, 0});
  weld(mesh);
  EXPECT_EQ(inspect(mesh).non_manifold_edges, 5U);  // four around the wall, and its diagonal
  const MeshReport report = repaired(mesh);
  EXPECT_TRUE(report.closed);
  EXPECT_EQ(report.triangles, 20U);
  EXPECT_NEAR(report.volume, 2.0, 1e-14);
  EXPECT_THAT(report.repairs, Contains(HasSubstr("walls without thickness")));
}

TEST(Repair, OfATwoSidedSurfaceOneSideStays) {
  Mesh mesh = surface_of({.shape = "torus"});
  const std::size_t triangles = mesh.triangles.size();
  Mesh inside = mesh;
  for (Triangle& t : inside.triangles) reverse(t);
  append(mesh, inside, Vec3::Zero());
  weld(mesh);
  const MeshReport report = repaired(mesh);
  EXPECT_EQ(report.triangles, triangles);
  EXPECT_TRUE(report.is_solid());
}

TEST(Repair, DuplicatesAndCollapsedTriangles) {
  Mesh mesh = surface_of({.shape = "cube"});
  mesh.triangles.push_back(mesh.triangles[2]);
  mesh.triangles.push_back({mesh.triangles[0][0], mesh.triangles[0][1], mesh.triangles[0][0]});
  const MeshReport report = repaired(mesh);
  EXPECT_EQ(report.triangles, 12U);
  EXPECT_EQ(report.duplicate_triangles, 1U);
  EXPECT_EQ(report.degenerate_triangles, 1U);
  EXPECT_TRUE(report.closed);
}

TEST(Repair, TinyCoordinatesAreNotDegenerate) {
  Mesh mesh = surface_of({.shape = "sphere", .size = 1e-120});
  EXPECT_EQ(repaired(mesh).degenerate_triangles, 0U);
}

TEST(Repair, OpenSurfacesAreLeftAlone) {
  Mesh mesh = surface_of({.shape = "sphere"});
  std::ranges::for_each(mesh.triangles, reverse);
  mesh.triangles.pop_back();
  EXPECT_THAT(repaired(mesh).repairs, IsEmpty());
}

TEST(Repair, AMoebiusStripHasOneSide) {
  Mesh mesh;
  constexpr std::uint32_t kSegments = 12;
  for (std::uint32_t s = 0; s < kSegments; ++s)
    for (const double side : {-0.3, 0.3}) {
      const double a = 2.0 * std::numbers::pi * s / kSegments;
      const double r = 1.0 + side * std::cos(a / 2.0);
      mesh.vertices.emplace_back(r * std::cos(a), r * std::sin(a), side * std::sin(a / 2.0));
    }
  for (std::uint32_t s = 0; s < kSegments; ++s) {
    const bool last = s + 1 == kSegments;
    const std::uint32_t a = 2 * s;
    const std::uint32_t b = 2 * s + 1;
    const std::uint32_t c = last ? 1 : 2 * s + 2;
    const std::uint32_t d = last ? 0 : 2 * s + 3;
    mesh.triangles.push_back({a, c, b});
    mesh.triangles.push_back({b, c, d});
  }
  EXPECT_THAT(repaired(mesh).warnings, Contains(HasSubstr("only one side")));
}

TEST(Repair, InvertedTetrahedra) {
  Mesh mesh = generate({.shape = "sphere"});
  const double volume = inspect(mesh).volume;
  for (std::size_t i = 0; i < mesh.tetrahedra.size(); i += 50)
    std::swap(mesh.tetrahedra[i][0], mesh.tetrahedra[i][1]);
  const MeshReport report = repaired(mesh);
  EXPECT_EQ(report.inverted_tetrahedra, 26U);
  EXPECT_NEAR(report.volume, volume, 1e-15);
  EXPECT_TRUE(report.closed && report.oriented);
}

}  // namespace
}  // namespace gotai::geometry
