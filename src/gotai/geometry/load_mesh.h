/// @file
/// Meshes from files: what is in the file, turned into metres with z up, and what was found.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "gotai/geometry/mesh.h"
#include "gotai/geometry/mesh_report.h"

namespace gotai::geometry {

/// How a file's numbers become metres in a frame with z up.
struct LoadOptions {
  /// Length unit of the file's numbers, one of length_unit_names().
  std::string unit = "m";
  /// The file's axis that points up: "x", "y" or "z"; empty is what the format prescribes (y for
  /// glTF) or else z.
  std::string up = "";  // NOLINT(readability-redundant-string-init): lets callers leave it out
  /// Extra factor, > 0.
  double scale = 1.0;
};

/// A mesh as the engine wants it, with what its file held and what was changed on the way.
struct LoadedMesh {
  Mesh mesh;
  MeshReport report;
};

/// "um", "mm", "cm", "dm", "m", "km", "in", "inch", "ft", "foot".
const std::vector<std::string>& length_unit_names();

/// Metres per unit.
/// @throws InvalidArgument with the allowed names
double length_unit(std::string_view name);

/// Reads a mesh file. The format is recognised by the content, whatever the extension says:
/// surfaces as OBJ, STL, PLY, OFF, glTF/GLB, VTK polydata; tetrahedra as gmsh 1.0 to 4.1, MEDIT,
/// TetGen (.node beside .ele; either may be named), legacy VTK. Polygons are cut into triangles.
/// Vertices at equal positions are welded. Defects that have one remedy are repaired and stated in
/// the report (see repair()); the others are reported only. Where a file has tetrahedra the surface
/// is their boundary.
/// @throws FileError with the path, the line where the format has lines, and what to do, when the
///         file cannot be read or understood, is empty, refers to vertices that it does not have,
///         or uses non-finite coordinates
/// @throws InvalidArgument for impossible options
LoadedMesh load_mesh(const std::filesystem::path& path, const LoadOptions& options = {});

/// The same from memory.
/// @param name   stands for the path in messages; its extension is a hint
/// @param bytes  the content of the file; formats that refer to other files look beside `name`
LoadedMesh read_mesh(const std::filesystem::path& name, std::string_view bytes,
                     const LoadOptions& options = {});

}  // namespace gotai::geometry
