#include "gotai/geometry/generate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <numbers>

#include "gotai/core/error.h"
#include "gotai/geometry/mass_properties.h"
#include "gotai/geometry/tetrahedra.h"

namespace gotai::geometry {
namespace {

using ::testing::HasSubstr;

double tetrahedra_volume(const Mesh& mesh) {
  double sum = 0.0;
  for (const Tetrahedron& tet : mesh.tetrahedra) sum += signed_volume(mesh, tet);
  return sum;
}

/// Every directed edge is met by exactly one edge the other way.
bool is_closed_and_oriented(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) ++balance[{t[k], t[(k + 1) % 3]}];
  return !mesh.triangles.empty() && std::ranges::all_of(balance, [&](const auto& entry) {
    const auto reverse = balance.find({entry.first.second, entry.first.first});
    return entry.second == 1 && reverse != balance.end() && reverse->second == 1;
  });
}

class EveryGenerator : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryGenerator, MakesPositiveTetrahedraInAClosedSurfaceOfTheWishedSize) {
  for (const double size : {0.0, 0.35})
    for (const int subdivisions : {0, 3}) {
      const Mesh mesh = generate({.shape = GetParam(), .size = size, .subdivisions = subdivisions});
      for (const Tetrahedron& tet : mesh.tetrahedra) ASSERT_GT(signed_volume(mesh, tet), 0.0);
      EXPECT_TRUE(is_closed_and_oriented(mesh));
      // The surface encloses exactly the tetrahedra: nothing overlaps, nothing is missing.
      Mesh surface = mesh;
      surface.tetrahedra.clear();
      EXPECT_NEAR(mass_properties(surface).volume, tetrahedra_volume(mesh),
                  1e-13 * tetrahedra_volume(mesh));
      if (size > 0.0) {
        EXPECT_NEAR(bounding_box(mesh).sizes().maxCoeff(), size, 1e-15);
      }
    }
}

INSTANTIATE_TEST_SUITE_P(Generate, EveryGenerator, ::testing::ValuesIn(generator_names()));

TEST(Generate, HexapodIsTheOneOfTheExperiments) {
  const Mesh mesh = generate({.shape = "hexapod"});
  EXPECT_EQ(mesh.tetrahedra.size(), 42U);
  EXPECT_EQ(mesh.vertices.size(), 32U);
  EXPECT_EQ(bounding_box(mesh).sizes(), Vec3::Constant(2.0));
  // Cube plus six frusta h/3 (A + a + sqrt(A a)).
  EXPECT_NEAR(mass_properties(mesh).volume, 0.175616 + 6.0 * 0.72 / 3.0 * 0.6448, 1e-14);
}

TEST(Generate, SphereOf1296Tetrahedra) {
  const Mesh mesh = generate({.shape = "sphere"});
  EXPECT_EQ(mesh.tetrahedra.size(), 1296U);
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) EXPECT_NEAR(mesh.vertices[v].norm(), 0.5, 1e-15);
}

/// The error of volume of an inscribed shape falls with the square of the cell size.
void expect_second_order(const std::string& shape, double exact, int coarse) {
  const auto error = [&](int n) {
    return exact - mass_properties(generate({.shape = shape, .subdivisions = n})).volume;
  };
  EXPECT_NEAR(std::log2(error(coarse) / error(2 * coarse)), 2.0, 0.1) << shape;
}

TEST(Generate, RoundShapesConvergeToTheirVolumes) {
  using std::numbers::pi;
  expect_second_order("sphere", pi / 6.0, 8);
  expect_second_order("cylinder", pi / 4.0, 8);
  expect_second_order("disc", pi / 40.0, 20);
  const double ring = 0.5 / 1.3;
  expect_second_order("torus", 2.0 * pi * pi * ring * std::pow(0.3 * ring, 2), 6);
}

TEST(Generate, BoxHasItsExtents) {
  const Mesh mesh = generate({.shape = "box", .extents = {1, 2, 4}});
  EXPECT_EQ(mesh.tetrahedra.size(), 6U);
  EXPECT_EQ(bounding_box(mesh).sizes(), Vec3(1, 2, 4));
  EXPECT_EQ(bounding_box(generate({.shape = "box", .size = 1, .extents = {1, 2, 4}})).sizes(),
            Vec3(0.25, 0.5, 1));
}

TEST(Generate, LIsFiveUnitCubes) {
  const Mesh mesh = generate({.shape = "l"});
  const MassProperties properties = mass_properties(mesh);
  EXPECT_NEAR(properties.volume, 5.0, 1e-14);
  EXPECT_LE((properties.center_of_mass - Vec3(-0.4, 0.0, -0.4)).norm(), 1e-14);
}

TEST(Generate, RockHasTheSameFormAtEveryFineness) {
  const Mesh coarse = generate({.shape = "rock", .subdivisions = 2, .seed = 5});
  const Mesh fine = generate({.shape = "rock", .subdivisions = 4, .seed = 5});
  EXPECT_EQ(coarse.triangles.size(), 320U);
  EXPECT_EQ(fine.triangles.size(), 5120U);
  for (std::size_t v = 0; v < coarse.vertices.size(); ++v)
    EXPECT_EQ(coarse.vertices[v], fine.vertices[v]);
  double low = 1.0;
  double high = 0.0;
  for (std::size_t v = 1; v < fine.vertices.size(); ++v) {
    low = std::min(low, fine.vertices[v].norm());
    high = std::max(high, fine.vertices[v].norm());
  }
  EXPECT_GE(low, 0.375);
  EXPECT_LE(high, 0.625);
  EXPECT_GT(high - low, 0.1);
  EXPECT_NE(generate({.shape = "rock", .seed = 6}).vertices,
            generate({.shape = "rock", .seed = 5}).vertices);
  // The same rock from every compiler.
  const Vec3 first = generate({.shape = "rock", .subdivisions = 2, .seed = 5}).vertices.at(1);
  EXPECT_LT((first - Vec3(-0.25823561244403864, 0.41783399804009991, 0.0)).norm(), 1e-12);
}

TEST(Generate, PlaneShapesFillTheirAreas) {
  const std::map<std::string, double> areas = {
      {"square", 1.0}, {"l", 5.0}, {"cross", 0.56 * 0.56 + 4.0 * 0.72 * 0.46}};
  for (const auto& name : plane_generator_names()) {
    const Mesh2 mesh = generate_plane({.shape = name, .subdivisions = name == "circle" ? 64 : 0});
    double area = 0.0;
    for (const auto& [a, b, c] : mesh.triangles) {
      const Vec2 ab = mesh.vertices[b] - mesh.vertices[a];
      const Vec2 ac = mesh.vertices[c] - mesh.vertices[a];
      const double cross = ab.x() * ac.y() - ab.y() * ac.x();
      EXPECT_GT(cross, 0.0) << name;
      area += cross / 2.0;
    }
    if (name == "circle")
      EXPECT_NEAR(area, std::numbers::pi / 4.0, 1e-3);
    else
      EXPECT_NEAR(area, areas.at(name), 1e-14) << name;
  }
}

std::string message_of(const GeneratorOptions& options) {
  try {
    generate(options);
  } catch (const InvalidArgument& error) {
    return error.what();
  }
  return "";
}

TEST(Generate, SaysWhatIsAllowed) {
  EXPECT_THAT(message_of({.shape = "ball"}), HasSubstr("hexapod, l, rock, sphere, torus"));
  EXPECT_THAT(message_of({.size = -1}), HasSubstr("size"));
  EXPECT_THAT(message_of({.shape = "box", .extents = {1, 0, 1}}), HasSubstr("extents"));
  EXPECT_THAT(message_of({.shape = "torus", .thickness = 1}), HasSubstr("thickness"));
  EXPECT_THAT(message_of({.shape = "rock", .roughness = 2}), HasSubstr("roughness"));
  EXPECT_THAT(message_of({.shape = "rock", .subdivisions = 20}), HasSubstr("1..8"));
}

}  // namespace
}  // namespace gotai::geometry
