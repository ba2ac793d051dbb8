#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "gotai/core/error.h"
#include "gotai/geometry/gltf_data.h"
#include "gotai/geometry/load_mesh.h"
#include "support/mesh_text.h"

namespace gotai::geometry {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

std::string base64(const std::string& bytes) {
  static const std::string alphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = (bits << 8U) | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k > bytes.size() ? '=' : alphabet[(bits >> (18 - 6 * k)) & 63U];
  }
  return text;
}

/// The unit tetrahedron under one node: positions as float, indices as unsigned short.
std::string tetrahedron_bytes() {
  std::string bytes;
  for (int v = 0; v < 4; ++v)
    for (int k = 0; k < 3; ++k) bytes += test::raw_bytes(v == k + 1 ? 1.0F : 0.0F);
  for (const int i : {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3})
    bytes += test::raw_bytes(static_cast<std::uint16_t>(i));
  return bytes;
}

json tetrahedron(const json& nodes) {
  return {{"asset", {{"version", "2.0"}}},
          {"scenes", {{{"nodes", {0}}}}},
          {"nodes", nodes},
          {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}}}}},
          {"accessors",
           {{{"bufferView", 0}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}},
            {{"bufferView", 1}, {"componentType", 5123}, {"count", 12}, {"type", "SCALAR"}}}},
          {"bufferViews",
           {{{"buffer", 0}, {"byteLength", 48}},
            {{"buffer", 0}, {"byteOffset", 48}, {"byteLength", 24}}}},
          {"buffers",
           {{{"byteLength", 72},
             {"uri", "data:application/octet-stream;base64," + base64(tetrahedron_bytes())}}}}};
}

LoadedMesh load(const json& nodes) { return read_mesh("t.gltf", tetrahedron(nodes).dump()); }

TEST(Gltf, IsTurnedFromYUp) {
  const LoadedMesh loaded = load({{{"mesh", 0}}});
  EXPECT_TRUE(loaded.report.is_solid());
  EXPECT_NEAR(loaded.report.volume, 1.0 / 6.0, 1e-15);
  const Box3 box = bounding_box(loaded.mesh);
  EXPECT_EQ(box.min(), Vec3(0, -1, 0));
  EXPECT_EQ(box.max(), Vec3(1, 0, 1));
  EXPECT_EQ(bounding_box(read_mesh("t.gltf", tetrahedron({{{"mesh", 0}}}).dump(), {.up = "z"}).mesh)
                .max(),
            Vec3(1, 1, 1));
}

TEST(Gltf, NodeTransformsAreChained) {
  // Parent: moves by 10 along y. Child: turns x to y (quarter turn about z), then scales x by 2.
  const double h = std::sqrt(0.5);
  const LoadedMesh loaded = load({{{"translation", {0, 10, 0}}, {"children", {1}}},
                                  {{"mesh", 0}, {"rotation", {0, 0, h, h}}, {"scale", {2, 1, 1}}}});
  EXPECT_NEAR(loaded.report.volume, 2.0 / 6.0, 1e-14);
  const Box3 box = bounding_box(loaded.mesh);  // y up: (-1..0, 10..12, 0..1), then turned
  EXPECT_LE((box.min() - Vec3(-1, -1, 10)).norm(), 1e-14);
  EXPECT_LE((box.max() - Vec3(0, 0, 12)).norm(), 1e-14);
}

TEST(Gltf, AMirroringMatrixKeepsTheOutsideOut) {
  const LoadedMesh loaded =
      load({{{"mesh", 0}, {"matrix", {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1}}}});
  EXPECT_NEAR(loaded.report.volume, 1.0 / 6.0, 1e-14);
  EXPECT_THAT(loaded.report.repairs, ::testing::IsEmpty());
  EXPECT_EQ(bounding_box(loaded.mesh).min().x(), 4.0);
}

TEST(Gltf, TwoNodesShowTheSameMesh) {
  const LoadedMesh loaded =
      load({{{"children", {1, 2}}}, {{"mesh", 0}}, {{"mesh", 0}, {"translation", {3, 0, 0}}}});
  EXPECT_EQ(loaded.report.components, 2U);
  EXPECT_NEAR(loaded.report.volume, 2.0 / 6.0, 1e-14);
}

TEST(Gltf, StripsAndFans) {
  json document = tetrahedron({{{"mesh", 0}}});
  document["meshes"][0]["primitives"][0]["mode"] = 5;
  document["accessors"][1]["count"] = 4;  // 0 2 1 0: a face and a collapsed one
  EXPECT_EQ(read_mesh("t.gltf", document.dump()).report.file_triangles, 2U);
  document["meshes"][0]["primitives"][0]["mode"] = 6;
  EXPECT_EQ(read_mesh("t.gltf", document.dump()).report.file_triangles, 2U);
  document["meshes"][0]["primitives"][0]["mode"] = 1;
  EXPECT_THAT(test::error_of("a.gltf", document.dump()), HasSubstr("points or lines"));
}

TEST(Gltf, BinaryContainer) {
  json document = tetrahedron({{{"mesh", 0}}});
  document["buffers"][0].erase("uri");
  std::string text = document.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::string data = tetrahedron_bytes();
  const auto u32 = [](std::size_t n) { return test::raw_bytes(static_cast<std::uint32_t>(n)); };
  const std::string body =
      u32(text.size()) + "JSON" + text + u32(data.size()) + std::string("BIN\0", 4) + data;
  const std::string glb = "glTF" + u32(2) + u32(12 + body.size()) + body;
  const LoadedMesh loaded = read_mesh("t.glb", glb);
  EXPECT_EQ(loaded.report.format, "glTF (binary)");
  EXPECT_TRUE(loaded.report.is_solid());
}

TEST(Gltf, HostileDocuments) {
  const json good = tetrahedron({{{"mesh", 0}}});
  EXPECT_THAT(
      test::error_of("a.gltf", tetrahedron({{{"children", {1}}}, {{"children", {0}}}}).dump()),
      HasSubstr("its own ancestor"));
  const auto with = [&](const std::string& path, const json& value) {
    json document = good;
    document[json::json_pointer(path)] = value;
    return test::error_of("a.gltf", document.dump());
  };
  EXPECT_THAT(with("/buffers/0/byteLength", 73), HasSubstr("truncated"));
  EXPECT_THAT(with("/buffers/0/uri", "../../etc/passwd"), HasSubstr("beside or below"));
  EXPECT_THAT(with("/buffers/0/uri", "/etc/passwd"), HasSubstr("beside or below"));
  EXPECT_THAT(with("/buffers/0/uri", "http://example.org/x.bin"), HasSubstr("beside or below"));
  EXPECT_THAT(with("/buffers/0/uri", "data:;base64,***"), HasSubstr("base64"));
  EXPECT_THAT(with("/accessors/0/count", 4000000000U), HasSubstr("larger than its bufferView"));
  EXPECT_THAT(with("/accessors/0/byteOffset", 44), HasSubstr("larger than its bufferView"));
  EXPECT_THAT(with("/accessors/0/count", -1), HasSubstr("a whole number should be"));
  EXPECT_THAT(with("/accessors/0/sparse", json::object()), HasSubstr("sparse"));
  EXPECT_THAT(with("/bufferViews/0/byteLength", 500), HasSubstr("larger than its buffer"));
  EXPECT_THAT(with("/bufferViews/0/byteStride", 0), HasSubstr("larger than its bufferView"));
  EXPECT_THAT(with("/scenes/0/nodes/0", 7), HasSubstr("nodes 7 does not exist"));
  EXPECT_THAT(with("/nodes/0/mesh", "x"), HasSubstr("a whole number should be"));
  EXPECT_THAT(with("/nodes/0/matrix", json{1, 2, 3}), HasSubstr("16 numbers"));
  EXPECT_THAT(with("/asset/version", "1.0"), HasSubstr("only 2.0"));
  EXPECT_THAT(with("/meshes/0/primitives/0/extensions", {{"KHR_draco_mesh_compression", 1}}),
              HasSubstr("without compression"));
  std::string nested(5000, '[');
  try {
    read_mesh("a.gltf", "{\"asset\":" + nested);
    ADD_FAILURE();
  } catch (const FileError& error) {
    EXPECT_THAT(error.what(), HasSubstr("nested too deeply"));
  }
}

TEST(Gltf, CountsAndIndicesAreWholeNumbers) {
  json document = tetrahedron({{{"mesh", 0}}});
  document["accessors"][0]["count"] = 4.0;  // JSON knows no difference
  EXPECT_EQ(read_mesh("t.gltf", document.dump()).report.vertices, 4u);
  for (const json& wrong : {json(2.2e26), json(1.5), json(-1), json("4"), json(nullptr)}) {
    for (const char* place :
         {"/accessors/0/count", "/accessors/0/bufferView", "/accessors/1/componentType",
          "/bufferViews/1/byteOffset", "/bufferViews/0/byteLength", "/buffers/0/byteLength",
          "/scenes/0/nodes/0", "/nodes/0/mesh", "/meshes/0/primitives/0/indices"}) {
      json bad = tetrahedron({{{"mesh", 0}}});
      bad[json::json_pointer(place)] = wrong;
      EXPECT_THAT(test::error_of("a.gltf", bad.dump()),
                  HasSubstr(wrong.dump() + " stands where a whole number should be"))
          << place;
    }
  }
}

TEST(Base64, DecodesAndRefuses) {
  std::string bytes;
  EXPECT_TRUE(detail::decode_base64("R290YWk=", bytes));
  EXPECT_EQ(bytes, "Gotai");
  EXPECT_FALSE(detail::decode_base64("R2$0", bytes));
}

}  // namespace
}  // namespace gotai::geometry
