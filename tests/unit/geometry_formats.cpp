// One tetrahedron or cube in every dialect that the readers know, and their errors.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "gotai/core/error.h"
#include "gotai/geometry/generate.h"
#include "gotai/geometry/load_mesh.h"
#include "support/mesh_text.h"

namespace gotai::geometry {
namespace {

using test::raw_bytes;
using test::swapped_bytes;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// The unit tetrahedron at the origin, or the unit cube: closed, outward.
void expect_solid(const LoadedMesh& loaded, double volume, const std::string& format) {
  SCOPED_TRACE(loaded.report.format);
  EXPECT_EQ(loaded.report.format, format);
  EXPECT_TRUE(loaded.report.closed && loaded.report.oriented);
  EXPECT_NEAR(loaded.report.volume, volume, 1e-6 * volume);
  EXPECT_THAT(loaded.report.warnings, ::testing::IsEmpty());
}

constexpr double kTet = 1.0 / 6.0;
constexpr const char* kPoints = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
constexpr int kFaces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

TEST(Ply, AsciiWithPropertiesItDoesNotNeed) {
  const std::string text =
      "ply\r\nformat ascii 1.0\ncomment by hand\nelement material 1\nproperty uchar r\n"
      "element vertex 4\nproperty float nx\nproperty double z\nproperty float y\nproperty float x\n"
      "element face 4\nproperty list uchar float texcoord\nproperty list uchar int vertex_index\n"
      "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n"
      "255\n9 0 0 0\n9 0 0 1 77 unexpected\n9 0 1 0\n9 1 0 0\n"
      "0 3 0 2 1\n1 .5 3 0 1 3\n0 3 0 3 2\n2 1 1 3 1 2 3\n0 1\n";
  expect_solid(read_mesh("t.ply", text), kTet, "PLY (ascii)");
}

template <typename Write>
std::string binary_ply(const char* order, const Write& number) {
  std::string bytes = fmt::format(
      "ply\nformat {} 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property double z\nelement face 4\nproperty list uchar uint vertex_indices\n"
      "property uchar flag\nend_header\n",
      order);
  for (int v = 0; v < 4; ++v) {
    bytes += number(v == 1 ? 1.0F : 0.0F) + number(v == 2 ? 1.0F : 0.0F);
    bytes += number(v == 3 ? 1.0 : 0.0);
  }
  for (const auto& face : kFaces) {
    bytes += '\3';
    for (const int v : face) bytes += number(static_cast<std::uint32_t>(v));
    bytes += '\7';
  }
  return bytes;
}

TEST(Ply, BinaryOfBothByteOrders) {
  const auto little = [](auto x) { return raw_bytes(x); };
  const auto big = [](auto x) { return swapped_bytes(x); };
  expect_solid(read_mesh("t", binary_ply("binary_little_endian", little)), kTet, "PLY (binary)");
  expect_solid(read_mesh("t", binary_ply("binary_big_endian", big)), kTet, "PLY (binary)");
}

TEST(Ply, Errors) {
  const std::string head = "ply\nformat ascii 1.0\n";
  EXPECT_THAT(test::error_of("a.ply", head), HasSubstr("end_header"));
  EXPECT_THAT(
      test::error_of("a.ply", head + "element vertex 4000000000\nproperty float x\nend_header\n"),
      HasSubstr("cannot hold so many"));
  EXPECT_THAT(
      test::error_of("a.ply", head + "element vertex 2\nproperty float x\nproperty float y\n"
                                     "property float z\nend_header\n0 0 0\n0 0\n"),
      AllOf(HasSubstr("a.ply:9"), HasSubstr("fewer numbers")));
  EXPECT_THAT(test::error_of("a.ply", head + "element vertex 1\nproperty half x\n"),
              HasSubstr("unknown type"));
  EXPECT_THAT(
      test::error_of("a.ply", head + "element face 1\nproperty list uchar int vertex_index\n"
                                     "end_header\n3 0 -1 2\n"),
      HasSubstr("index -1"));
  EXPECT_THAT(test::error_of("a.ply", "ply\nformat utf8 1.0\n"), HasSubstr("binary_big_endian"));
}

TEST(Off, WithCommentsColoursAndPrefix) {
  const std::string faces = "3 0 2 1 255 0 0\n3 0 1 3\n3 0 3 2\n3 1 2 3 0.5\n";
  expect_solid(read_mesh("t.off", std::string("# made by hand\nOFF\n4 4\n") + kPoints + faces),
               kTet, "OFF");
  expect_solid(read_mesh("t",
                         "COFF 4 4 0 # counts\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n\n"
                         "0 1 0 1 1 1 1\n0 0 1 1 1 1 1\n" +
                             faces),
               kTet, "OFF");
  expect_solid(read_mesh("headless.off", std::string("4 4 6\n") + kPoints + faces), kTet, "OFF");
  EXPECT_THAT(test::error_of("a.off", "OFF BINARY\n1 2 3"), HasSubstr("binary OFF"));
  EXPECT_THAT(test::error_of("a.off", "4OFF\n1 2 3"), HasSubstr("dimensions"));
  EXPECT_THAT(test::error_of("a.off", "OFF\n-3 2 3"), HasSubstr("negative"));
}

TEST(Medit, TetrahedraWithSectionsItDoesNotNeed) {
  const std::string text =
      "MeshVersionFormatted 2\nDimension\n3\n# a comment\nVertices\n4\n"
      "0 0 0 1\n1 0 0 1\n0 1 0 1\n0 0 1 1\nRequiredVertices\n2\n1\n2\n"
      "Tetrahedra\n1\n1 2 3 4 7\nEnd\nnothing counts here\n";
  expect_solid(read_mesh("t.mesh", text), kTet, "MEDIT");
  EXPECT_THAT(test::error_of("a.mesh", "MeshVersionFormatted 1\nDimension 2\n"),
              HasSubstr("dimension 2"));
  EXPECT_THAT(test::error_of("a.mesh", "MeshVersionFormatted 1\nTetrahedra 1\n0 1 2 3 0\n"),
              AllOf(HasSubstr("a.mesh:3"), HasSubstr("counts from 1")));
  EXPECT_THAT(
      test::error_of("a.mesh",
                     "MeshVersionFormatted 1\nVertices 1 0 0 0 1\nTetrahedra 1\n1 1 1 99 0\n"),
      AllOf(HasSubstr("a.mesh:4"), HasSubstr("vertex 98")));
}

TEST(TetGen, EitherFileOfThePair) {
  const std::filesystem::path folder =
      std::filesystem::path(::testing::TempDir()) / "gotai_tetgen_test";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "t.node")
      << "# nodes\n4 3 1 0\n0 0 0 0 9\n1 1 0 0 9\n2 0 1 0 9\n3 0 0 1 9\n";
  EXPECT_THROW(load_mesh(folder / "t.node"), FileError);
  std::ofstream(folder / "t.ele") << "1 4 1\n0 0 1 2 3 5\n";
  expect_solid(load_mesh(folder / "t.node"), kTet, "TetGen");
  expect_solid(load_mesh(folder / "t.ele"), kTet, "TetGen");
  std::ofstream(folder / "t.ele") << "1 4 1\n0 0 1 2 4 5\n";
  EXPECT_THROW(load_mesh(folder / "t.ele"), FileError);
  std::filesystem::remove_all(folder);
}

constexpr const char* kVtkHead = "# vtk DataFile Version 3.0\na title\n";

TEST(Vtk, AsciiGridWithFieldAndMetadata) {
  const std::string text =
      std::string(kVtkHead) +
      "ASCII\nDATASET UNSTRUCTURED_GRID\nFIELD FieldData 1\nTIME 1 2 double\n"
      "0.5 7\nPOINTS 4 double\n" +
      kPoints +
      "METADATA\nINFORMATION 1\nNAME X LOCATION Y\n\nCELLS 2 8\n2 0 1\n4 0 1 2 "
      "3\nCELL_TYPES 2\n3\n10\nPOINT_DATA 4\nSCALARS nonsense\n";
  expect_solid(read_mesh("t.vtk", text), kTet, "VTK (ascii)");
}

TEST(Vtk, AsciiVersion5) {
  const std::string text = std::string("# vtk DataFile Version 5.1\nx\nASCII\nDATASET POLYDATA\n") +
                           "POINTS 4 float\n" + kPoints +
                           "POLYGONS 5 12\nOFFSETS vtktypeint64\n0 3 6 9 12\nCONNECTIVITY "
                           "vtktypeint64\n0 2 1 0 1 3 0 3 2 1 2 3\n";
  expect_solid(read_mesh("t.vtk", text), kTet, "VTK (ascii)");
}

TEST(Vtk, BinaryPolydataWithStrip) {
  std::string bytes = std::string(kVtkHead) + "BINARY\nDATASET POLYDATA\nPOINTS 4 float\n";
  for (int v = 0; v < 4; ++v)
    for (int k = 0; k < 3; ++k) bytes += swapped_bytes(v == k + 1 ? 1.0F : 0.0F);
  bytes += "\nPOLYGONS 2 8\n";
  for (const int n : {3, 0, 2, 1, 3, 0, 1, 3}) bytes += swapped_bytes(n);
  bytes += "\nTRIANGLE_STRIPS 1 5\n";  // 0 3 2 and (odd, so turned) 3 1 2
  for (const int n : {4, 0, 3, 2, 1}) bytes += swapped_bytes(n);
  expect_solid(read_mesh("t.vtk", bytes + "\n"), kTet, "VTK (binary)");
}

TEST(Vtk, BinaryVersion5Grid) {
  std::string bytes =
      "# vtk DataFile Version 5.1\nx\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n";
  for (int v = 0; v < 4; ++v)
    for (int k = 0; k < 3; ++k) bytes += swapped_bytes(v == k + 1 ? 1.0 : 0.0);
  bytes += "\nCELLS 2 4\nOFFSETS vtktypeint64\n";
  for (const std::int64_t n : {0, 4}) bytes += swapped_bytes(n);
  bytes += "\nCONNECTIVITY vtktypeint64\n";
  for (const std::int64_t n : {0, 1, 2, 3}) bytes += swapped_bytes(n);
  bytes += "\nCELL_TYPES 1\n" + swapped_bytes(10) + "\n";
  expect_solid(read_mesh("t.vtk", bytes), kTet, "VTK (binary)");
}

TEST(Vtk, Errors) {
  EXPECT_THAT(test::error_of("a.vtk", std::string(kVtkHead) + "ASCII\nDATASET STRUCTURED_POINTS\n"),
              HasSubstr("only UNSTRUCTURED_GRID and POLYDATA"));
  EXPECT_THAT(test::error_of("a.vtk", std::string(kVtkHead) +
                                          "ASCII\nDATASET POLYDATA\nPOLYGONS 1 4\n9 0 1 2\n"),
              HasSubstr("a cell of 9 points"));
  EXPECT_THAT(test::error_of("a.vtk", std::string(kVtkHead) +
                                          "ASCII\nDATASET UNSTRUCTURED_GRID\nCELL_TYPES 1\n5\n"),
              HasSubstr("0 cells but 1 cell types"));
}

template <typename Write>
std::string binary_gmsh2(const Write& number) {
  std::string bytes = "$MeshFormat\n2.2 1 8\n" + number(1) + "\n$EndMeshFormat\n$Nodes\n4\n";
  for (int v = 0; v < 4; ++v) {
    bytes += number(v + 1);
    for (int k = 0; k < 3; ++k) bytes += number(v == k + 1 ? 1.0 : 0.0);
  }
  bytes += "\n$EndNodes\n$Elements\n2\n";
  for (const int n : {15, 1, 2, /**/ 1, 0, 0, 1}) bytes += number(n);
  for (const int n : {4, 1, 2, /**/ 2, 0, 0, 1, 2, 3, 4}) bytes += number(n);
  return bytes + "\n$EndElements\n";
}

template <typename Write>
std::string binary_gmsh41(const Write& number) {
  const auto size = [&](std::int64_t n) { return number(n); };
  std::string bytes = "$MeshFormat\n4.1 1 8\n" + number(1) + "\n$EndMeshFormat\n$Nodes\n" +
                      size(1) + size(4) + size(1) + size(4) + number(3) + number(0) + number(0) +
                      size(4);
  for (int v = 0; v < 4; ++v) bytes += size(v + 1);
  for (int v = 0; v < 4; ++v)
    for (int k = 0; k < 3; ++k) bytes += number(v == k + 1 ? 1.0 : 0.0);
  bytes += "\n$EndNodes\n$Elements\n" + size(1) + size(1) + size(1) + size(1) + number(3) +
           number(0) + number(4) + size(1);
  for (const int n : {1, 1, 2, 3, 4}) bytes += size(n);
  return bytes + "\n$EndElements\n";
}

TEST(Gmsh, BinaryOfBothByteOrders) {
  const auto little = [](auto x) { return raw_bytes(x); };
  const auto big = [](auto x) { return swapped_bytes(x); };
  expect_solid(read_mesh("t.msh", binary_gmsh2(little)), kTet, "gmsh 2.2 (binary)");
  expect_solid(read_mesh("t.msh", binary_gmsh2(big)), kTet, "gmsh 2.2 (binary)");
  expect_solid(read_mesh("t.msh", binary_gmsh41(little)), kTet, "gmsh 4.1 (binary)");
  expect_solid(read_mesh("t.msh", binary_gmsh41(big)), kTet, "gmsh 4.1 (binary)");
}

TEST(Detection, ByContentWhateverTheExtension) {
  const std::string obj = test::obj_text(generate({.shape = "cube"}));
  expect_solid(read_mesh("cube.xyz", obj), 1.0, "OBJ");
  expect_solid(read_mesh("cube.obj", test::binary_stl(generate({.shape = "cube"}))), 1.0,
               "STL (binary)");
  EXPECT_THAT(test::error_of("a.stl", "PK\x03\x04 and so on"), HasSubstr("zip"));
  EXPECT_THAT(test::error_of("a.obj", "<?xml version='1.0'?>"), HasSubstr("XML"));
  EXPECT_THAT(test::error_of("a.mesh", "MFEM mesh v1.0\n"), HasSubstr("MFEM"));
  EXPECT_THAT(test::error_of("a.step", "ISO-10303-21;\n"), HasSubstr("STEP"));
  EXPECT_THAT(test::error_of("letter.txt", "Dear reader,\n"),
              HasSubstr("no mesh of a known format"));
}

}  // namespace
}  // namespace gotai::geometry
