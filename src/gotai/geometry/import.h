/// @file
/// What the readers of the single formats deliver. Internal to the module.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "gotai/core/types.h"
#include "gotai/geometry/mesh.h"

namespace gotai::geometry::detail {

/// The content of a file before any interpretation of the geometry.
struct Import {
  std::string format;          ///< as written in reports, for example "STL (binary)"
  char up = 'z';               ///< what the format prescribes
  std::vector<Vec3> vertices;  ///< in the file's unit and frame
  /// Polygons one after the other: polygon i has corners[first[i]] .. corners[first[i + 1] - 1].
  std::vector<std::uint32_t> corners;
  std::vector<std::size_t> first = {0};
  std::vector<Tetrahedron> tetrahedra;
  /// Lines where vertices, polygons and tetrahedra are; empty for formats without lines.
  std::vector<std::size_t> vertex_lines;
  std::vector<std::size_t> polygon_lines;
  std::vector<std::size_t> tetrahedron_lines;
  /// Sentences about content that was not used.
  std::vector<std::string> notes;

  std::size_t polygon_count() const { return first.size() - 1; }
  /// Ends the polygon whose corners were appended to `corners`.
  void end_polygon() { first.push_back(corners.size()); }
};

/// A file in memory. The readers below throw FileError.
struct Source {
  std::filesystem::path path;  ///< for messages and for files beside this one
  std::string_view bytes;
};

/// The whole content of a file.
/// @throws FileError when it does not exist or cannot be read
std::string read_bytes(const std::filesystem::path& path);

/// Recognises the format and reads it.
Import import(const Source& source);

Import read_gltf(const Source& source);
Import read_gmsh(const Source& source);
Import read_medit(const Source& source);
Import read_obj(const Source& source);
Import read_off(const Source& source);
Import read_ply(const Source& source);
Import read_stl(const Source& source);
/// The two files of a TetGen mesh.
Import read_tetgen(const Source& nodes, const Source& elements);
Import read_vtk(const Source& source);

}  // namespace gotai::geometry::detail
