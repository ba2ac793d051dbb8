#include "gotai/geometry/mass_properties.h"

#include <gtest/gtest.h>

#include "gotai/core/error.h"
#include "gotai/core/random.h"
#include "gotai/geometry/generate.h"
#include "gotai/geometry/tetrahedra.h"
#include "support/golden.h"

namespace gotai::geometry {
namespace {

Vec3 vector_of(const nlohmann::json& j) {
  return Vec3(j[0].get<double>(), j[1].get<double>(), j[2].get<double>());
}

Mesh mesh_of(const nlohmann::json& j) {
  Mesh mesh;
  for (const auto& v : j["vertices"]) mesh.vertices.push_back(vector_of(v));
  for (const auto& t : j["tets"]) mesh.tetrahedra.push_back({t[0], t[1], t[2], t[3]});
  return mesh;
}

void expect_equal(const MassProperties& actual, const nlohmann::json& expected) {
  SCOPED_TRACE(expected["name"].get<std::string>());
  Mat3 inertia;
  for (int i = 0; i < 3; ++i) inertia.row(i) = vector_of(expected["inertia_com"][i]).transpose();
  const double tolerance = 1e-12 * inertia(0, 0);
  const double mass = expected["mass"];
  const Vec3 com = vector_of(expected["com"]);
  EXPECT_NEAR(actual.volume, mass, 1e-12 * mass);
  EXPECT_LE((actual.center_of_mass - com).norm(), 1e-12 * std::max(1.0, com.norm()));
  EXPECT_LE((actual.inertia - inertia).cwiseAbs().maxCoeff(), tolerance);
}

TEST(MassProperties, OfTetrahedraEqualTheGoldenCases) {
  const nlohmann::json golden = test::golden("mass.json");
  for (const auto& expected : golden["cases"])
    expect_equal(mass_properties(mesh_of(expected)), expected);
}

TEST(MassProperties, OfTheBoundaryEqualTheGoldenCases) {
  const nlohmann::json golden = test::golden("mass.json");
  for (const auto& expected : golden["cases"]) {
    Mesh mesh = mesh_of(expected);
    orient_tetrahedra(mesh);
    mesh.triangles = boundary_triangles(mesh.tetrahedra);
    mesh.tetrahedra.clear();
    expect_equal(mass_properties(mesh), expected);
  }
}

TEST(MassProperties, RefusesVolumesThatAreNotPositive) {
  Mesh mesh = generate({.shape = "cube"});
  mesh.tetrahedra.clear();
  for (Triangle& t : mesh.triangles) std::swap(t[0], t[1]);
  EXPECT_THROW(mass_properties(mesh), InvalidArgument);
  EXPECT_THROW(mass_properties(Mesh{}), InvalidArgument);
}

TEST(PrincipalAxes, GiveTheTensorBack) {
  Random random(7);
  for (int trial = 0; trial < 50; ++trial) {
    const Mat3 rotation = random.rotation().toRotationMatrix();
    const Vec3 moments(random.uniform(1, 2), random.uniform(2, 3), random.uniform(3, 4));
    const Mat3 inertia = rotation * moments.asDiagonal() * rotation.transpose();
    const PrincipalAxes axes = principal_axes(inertia);
    EXPECT_LE((axes.moments - moments).norm(), 1e-13);
    const Mat3 r = axes.q_BP.toRotationMatrix();
    EXPECT_LE((r * axes.moments.asDiagonal() * r.transpose() - inertia).norm(), 1e-13);
  }
}

}  // namespace
}  // namespace gotai::geometry
