#include "gotai/geometry/load_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gotai/core/error.h"
#include "gotai/geometry/generate.h"
#include "gotai/geometry/mass_properties.h"
#include "support/mesh_text.h"

namespace gotai::geometry {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* kTetrahedronObj =
    "# a comment\n"
    "v .5 0 0\nv +1.5 0 0\nv .5 1. 0\nv .5 0 1e0 0.1 nan 0.3\n"
    "vn 0 0 1\nvt 0 0\n"
    "f 1/1/1 3/1/1 2/1/1\nf 1//1 2//1 4//1\nf -4 -1 \\\n -2\nf 2 3 4\n";

TEST(LoadMesh, ObjInAllItsNotations) {
  const LoadedMesh loaded = read_mesh("tet.obj", kTetrahedronObj);
  EXPECT_EQ(loaded.report.format, "OBJ");
  EXPECT_TRUE(loaded.report.closed);
  EXPECT_TRUE(loaded.report.is_solid());
  EXPECT_NEAR(loaded.report.volume, 1.0 / 6.0, 1e-15);
  EXPECT_THAT(loaded.report.repairs, IsEmpty());
  EXPECT_THAT(loaded.report.warnings, IsEmpty());
}

TEST(LoadMesh, ObjErrorsNameTheLine) {
  EXPECT_THAT(test::error_of("a.obj", "v 0 0 0\nf 0 1 2\n"),
              AllOf(HasSubstr("a.obj:2"), HasSubstr("counts from 1")));
  EXPECT_THAT(test::error_of("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 9\n"),
              AllOf(HasSubstr("a.obj:5"), HasSubstr("vertex 8")));
  EXPECT_THAT(test::error_of("a.obj", "v 0 0 x\n"), AllOf(HasSubstr("a.obj:1"), HasSubstr("'x'")));
  EXPECT_THAT(test::error_of("a.obj", "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n"),
              AllOf(HasSubstr("a.obj:2"), HasSubstr("finite")));
  EXPECT_THAT(test::error_of("a.obj", "v 0 0 0\nv 1 1e999 0\nv 0 1 0\nf 1 2 3\n"),
              HasSubstr("finite"));
  EXPECT_THAT(test::error_of("a.obj", "v 0 0 0\nf 1 1\n"), HasSubstr("three vertices"));
  EXPECT_THAT(test::error_of("a.obj", "v 0 0 0\n"), HasSubstr("no faces"));
  EXPECT_THAT(test::error_of("a.obj", ""), HasSubstr("empty"));
}

TEST(LoadMesh, FilesThatCannotBeRead) {
  EXPECT_THROW(load_mesh("no/such/file.obj"), FileError);
  EXPECT_THROW(load_mesh("."), FileError);
  EXPECT_THROW(load_mesh("/dev/null"), FileError);
}

TEST(LoadMesh, UnitUpAndScale) {
  const std::string text = test::obj_text(generate({.shape = "box", .extents = {1, 2, 3}}));
  const auto sizes = [&](const LoadOptions& options) {
    return Vec3(bounding_box(read_mesh("box.obj", text, options).mesh).sizes());
  };
  EXPECT_EQ(sizes({.unit = "mm", .scale = 1000.0}), Vec3(1, 2, 3));
  EXPECT_EQ(sizes({.unit = "inch"}), Vec3(0.0254, 0.0508, 3 * 0.0254));
  EXPECT_EQ(sizes({.up = "y"}), Vec3(1, 3, 2));
  EXPECT_EQ(sizes({.up = "x"}), Vec3(2, 3, 1));
  for (const char* up : {"x", "y", "z"})  // rotations, not reflections
    EXPECT_NEAR(read_mesh("box.obj", text, {.up = up}).report.volume, 6.0, 1e-14);
  EXPECT_THAT(test::error_of("a.obj", text, {.unit = "furlong"}), HasSubstr("um, mm, cm"));
  EXPECT_THAT(test::error_of("a.obj", text, {.up = "w"}), HasSubstr("x, y or z"));
  EXPECT_THAT(test::error_of("a.obj", text, {.scale = 0.0}), HasSubstr("scale"));
}

TEST(LoadMesh, TheAxisGivenAsUpPointsUp) {
  const std::string text =
      "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  EXPECT_EQ(bounding_box(read_mesh("t.obj", text, {.up = "y"}).mesh).max().z(), 2.0);
  EXPECT_EQ(bounding_box(read_mesh("t.obj", text, {.up = "x"}).mesh).max().z(), 1.0);
}

TEST(LoadMesh, BinaryStlThatStartsWithSolid) {
  const Mesh torus = generate({.shape = "torus"});
  const LoadedMesh loaded = read_mesh("torus.stl", test::binary_stl(torus));
  EXPECT_EQ(loaded.report.format, "STL (binary)");
  EXPECT_EQ(loaded.report.file_vertices, 3 * torus.triangles.size());
  EXPECT_EQ(loaded.report.triangles, torus.triangles.size());
  EXPECT_TRUE(loaded.report.closed);
  EXPECT_NEAR(loaded.report.volume, mass_properties(torus).volume, 1e-7);
}

TEST(LoadMesh, StlOfTheWrongSize) {
  std::string bytes = test::binary_stl(generate({.shape = "cube"}));
  bytes.resize(bytes.size() - 60);
  EXPECT_THAT(test::error_of("cut.stl", bytes),
              AllOf(HasSubstr("facets is 12"), HasSubstr("truncated")));
}

TEST(LoadMesh, AsciiStl) {
  std::string text = "SOLID a name with facet in it\n";
  const Mesh cube = generate({.shape = "cube"});
  for (const Triangle& t : cube.triangles) {
    text += "facet normal 0 0 0\n  outer loop\n";
    for (const std::uint32_t v : t)
      text += fmt::format("    vertex {} {} {}\n", cube.vertices[v].x(), cube.vertices[v].y(),
                          cube.vertices[v].z());
    text += "  endloop\nendfacet\n";
  }
  const LoadedMesh loaded = read_mesh("cube.stl", text + "endsolid a name with facet in it\n");
  EXPECT_EQ(loaded.report.format, "STL (ascii)");
  EXPECT_EQ(loaded.mesh.vertices.size(), 8U);
  EXPECT_NEAR(loaded.report.volume, 1.0, 1e-15);
  EXPECT_THAT(test::error_of("cube.stl", text + "vertex 1 2"), HasSubstr("ends where"));
  EXPECT_THAT(test::error_of("cube.stl", text + "facet normal 0 0 0\nvertex 1 2 3\n"),
              HasSubstr("within a facet"));
  EXPECT_THAT(test::error_of("cube.stl", "solid x\nfoo\n"), HasSubstr("cube.stl:2"));
}

constexpr const char* kGmsh2 =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Private\nwhat ever\n$EndPrivate\n"
    "$Nodes\n4\n10 0 0 0\n20 1 0 0\n30 0 1 0\n40 0 0 1\n$EndNodes\n"
    "$Elements\n3\n1 15 2 0 1 10\n2 2 2 0 1 10 30 20\n3 4 2 0 1 10 20 30 40\n$EndElements\n";
constexpr const char* kGmsh41 =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
    "$Nodes\n2 4 1 4\n1 1 1 2\n1\n2\n0 0 0 0.5\n1 0 0 0.7\n3 1 0 2\n3\n4\n0 1 0\n0 0 1\n$EndNodes\n"
    "$Elements\n1 1 1 1\n3 1 4 1\n7 1 2 3 4\n$EndElements\n";
constexpr const char* kGmsh40 =
    "$MeshFormat\n4 0 8\n$EndMeshFormat\n"
    "$Nodes\n1 4\n1 3 0 4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n"
    "$Elements\n1 1\n1 3 4 1\n7 1 2 3 4\n$EndElements\n";
constexpr const char* kGmsh1 =
    "$NOD\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$ENDNOD\n$ELM\n1\n1 4 1 1 4 1 2 3 4\n$ENDELM\n";

TEST(LoadMesh, GmshOfEveryVersion) {
  for (const char* text : {kGmsh1, kGmsh2, kGmsh40, kGmsh41}) {
    const LoadedMesh loaded = read_mesh("tet.msh", text);
    SCOPED_TRACE(loaded.report.format);
    EXPECT_EQ(loaded.report.tetrahedra, 1U);
    EXPECT_EQ(loaded.report.triangles, 4U);
    EXPECT_TRUE(loaded.report.closed);
    EXPECT_NEAR(loaded.report.volume, 1.0 / 6.0, 1e-15);
  }
  EXPECT_EQ(read_mesh("tet.msh", kGmsh2).report.file_triangles, 1U);
}

TEST(LoadMesh, GmshErrorsNameTheLine) {
  std::string text = kGmsh2;
  EXPECT_THAT(test::error_of("a.msh", text.substr(0, text.find("$EndElements"))),
              HasSubstr("does not end with $EndElements"));
  EXPECT_THAT(test::error_of("a.msh", std::string(kGmsh2).replace(text.find("20 30 40"), 2, "77")),
              AllOf(HasSubstr("a.msh:18"), HasSubstr("node 77")));
  EXPECT_THAT(
      test::error_of("a.msh", std::string(kGmsh2).replace(text.find("\n4\n") + 1, 1, "900000000")),
      HasSubstr("cannot hold so many"));
  EXPECT_THAT(test::error_of("a.msh", std::string(kGmsh2).replace(text.find("2.2"), 3, "7.7")),
              HasSubstr("version"));
}

}  // namespace
}  // namespace gotai::geometry
