/// @file
/// Small meshes as file contents for tests.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <string>

#include "gotai/core/error.h"
#include "gotai/geometry/generate.h"
#include "gotai/geometry/load_mesh.h"

namespace gotai::test {

inline std::string obj_text(const geometry::Mesh& mesh) {
  std::string text;
  for (const Vec3& v : mesh.vertices) text += fmt::format("v {} {} {}\n", v.x(), v.y(), v.z());
  for (const geometry::Triangle& t : mesh.triangles)
    text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return text;
}

/// The surface of a generated shape; some have no subdivisions.
inline geometry::Mesh generated_surface(const std::string& shape, int subdivisions = 0) {
  geometry::GeneratorOptions options;
  options.shape = shape;
  options.subdivisions = subdivisions;
  geometry::Mesh mesh = geometry::generate(options);
  mesh.tetrahedra.clear();
  return mesh;
}

/// The bytes of a value, as they lie in memory.
template <typename T>
std::string raw_bytes(T value) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  return bytes;
}

/// The same in the other byte order.
template <typename T>
std::string swapped_bytes(T value) {
  std::string bytes = raw_bytes(value);
  std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

inline std::string binary_stl(const geometry::Mesh& mesh) {
  std::string bytes = "solid is how many binary files begin, too";
  bytes.resize(80, ' ');
  bytes += raw_bytes(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const geometry::Triangle& t : mesh.triangles) {
    bytes.append(12, '\0');
    for (const std::uint32_t v : t)
      for (const double x : mesh.vertices[v]) bytes += raw_bytes(static_cast<float>(x));
    bytes.append(2, '\0');
  }
  return bytes;
}

/// The message of the error that these bytes give; empty when they load.
inline std::string error_of(const std::string& name, const std::string& bytes,
                            const geometry::LoadOptions& options = {}) {
  try {
    geometry::read_mesh(name, bytes, options);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace gotai::test
