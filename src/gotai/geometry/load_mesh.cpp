#include "gotai/geometry/load_mesh.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "gotai/core/error.h"
#include "gotai/geometry/import.h"
#include "gotai/geometry/triangulate.h"

namespace gotai::geometry {

namespace {

const std::vector<std::pair<std::string, double>>& units() {
  static const std::vector<std::pair<std::string, double>> table = {
      {"um", 1e-6}, {"mm", 1e-3},   {"cm", 1e-2},     {"dm", 1e-1},   {"m", 1.0},
      {"km", 1e3},  {"in", 0.0254}, {"inch", 0.0254}, {"ft", 0.3048}, {"foot", 0.3048}};
  return table;
}

/// Rotation that brings the file's up axis to z; cyclic for x, a quarter turn about x for y.
Mat3 to_z_up(char up) {
  Mat3 r = Mat3::Identity();
  if (up == 'y') r << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  if (up == 'x') r << 0, 1, 0, 0, 0, 1, 1, 0, 0;
  return r;
}

[[noreturn]] void fail(const std::filesystem::path& name, const std::vector<std::size_t>& lines,
                       std::size_t element, const std::string& reason) {
  throw FileError(name.string(), element < lines.size() ? lines[element] : 0, 0, reason);
}

/// Every index must be in range and every vertex that is used finite.
void check_vertex(const std::filesystem::path& name, const detail::Import& import,
                  const std::vector<std::size_t>& lines, std::size_t element, std::string_view kind,
                  std::uint32_t v) {
  if (v >= import.vertices.size())
    fail(name, lines, element,
         fmt::format("{} {} refers to vertex {} (counted from 0), but the file has {} vertices",
                     kind, element, v, import.vertices.size()));
  const Vec3& p = import.vertices[v];
  if (!p.allFinite())
    fail(name, import.vertex_lines, v,
         fmt::format("vertex {} (counted from 0) is ({}, {}, {}); coordinates must be finite. "
                     "Remove the faces that use it or export the mesh again",
                     v, p.x(), p.y(), p.z()));
}

Mesh build(const std::filesystem::path& name, const detail::Import& import) {
  constexpr std::size_t kMostCorners = 4096;
  Mesh mesh;
  mesh.triangles.reserve(import.polygon_count());
  for (std::size_t i = 0; i < import.polygon_count(); ++i) {
    const std::span<const std::uint32_t> corners(import.corners.data() + import.first[i],
                                                 import.first[i + 1] - import.first[i]);
    for (const std::uint32_t v : corners)
      check_vertex(name, import, import.polygon_lines, i, "face", v);
    if (corners.size() > kMostCorners)
      fail(name, import.polygon_lines, i,
           fmt::format("face {} has {} corners; cut faces of more than {} into smaller ones", i,
                       corners.size(), kMostCorners));
    detail::triangulate(import.vertices, corners, mesh.triangles);
  }
  for (std::size_t i = 0; i < import.tetrahedra.size(); ++i)
    for (const std::uint32_t v : import.tetrahedra[i])
      check_vertex(name, import, import.tetrahedron_lines, i, "tetrahedron", v);
  return mesh;
}

void place(Mesh& mesh, double factor, char up) {
  const Mat3 rotation = to_z_up(up);
  for (Vec3& v : mesh.vertices) v = factor * (up == 'z' ? v : Vec3(rotation * v));
}

std::string plural(std::size_t count, std::string_view one, std::string_view many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

/// What stays as it is, in words.
void add_warnings(MeshReport& report) {
  auto& w = report.warnings;
  const double largest = report.extents.maxCoeff();
  const double smallest = report.extents.minCoeff();
  if (largest > 1000.0 || largest < 1e-3)
    w.push_back(
        fmt::format("the largest extent is {:.3g} m; was the file's unit meant to be "
                    "another than given?",
                    largest));
  if (report.boundary_edges > 0)
    w.push_back(
        fmt::format("not closed: {}", plural(report.boundary_edges, "edge has one face (a hole)",
                                             "edges have one face (holes)")));
  if (report.non_manifold_edges > 0)
    w.push_back(plural(report.non_manifold_edges, "edge has more than two faces",
                       "edges have more than two faces"));
  if (report.misoriented_edges > 0)
    w.push_back(plural(report.misoriented_edges,
                       "edge joins two faces that disagree on which side is out",
                       "edges join two faces that disagree on which side is out"));
  if (report.self_intersections > 0)
    w.push_back(fmt::format("the surface crosses itself: {}{} pairs of triangles meet",
                            report.self_intersections_complete ? "" : "at least ",
                            report.self_intersections));
  if (smallest <= 1e-9 * largest)
    w.push_back("the mesh is flat: it encloses no volume");
  else if (report.closed && report.volume < 0.0)
    w.push_back("the surface is inside out");
}

}  // namespace

const std::vector<std::string>& length_unit_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const auto& [name, metres] : units()) list.push_back(name);
    return list;
  }();
  return names;
}

double length_unit(std::string_view name) {
  for (const auto& [known, metres] : units())
    if (known == name) return metres;
  throw InvalidArgument("unit", std::string(name),
                        fmt::format("must be one of {}", fmt::join(length_unit_names(), ", ")));
}

LoadedMesh read_mesh(const std::filesystem::path& name, std::string_view bytes,
                     const LoadOptions& options) {
  const double unit = length_unit(options.unit);
  if (!(std::isfinite(options.scale) && options.scale > 0.0))
    throw InvalidArgument("scale", fmt::format("{}", options.scale), "must be > 0");
  if (!options.up.empty() && options.up != "x" && options.up != "y" && options.up != "z")
    throw InvalidArgument("up", options.up, "must be x, y or z");

  detail::Import import = detail::import({name, bytes});
  LoadedMesh loaded;
  Mesh& mesh = loaded.mesh;
  mesh = build(name, import);
  if (mesh.triangles.empty() && import.tetrahedra.empty())
    throw FileError(name.string(),
                    import.notes.empty()
                        ? fmt::format("has no faces and no tetrahedra (read as {})", import.format)
                        : fmt::format("has nothing to use: {}", fmt::join(import.notes, "; ")));

  MeshReport counts;
  counts.format = import.format;
  counts.file_vertices = import.vertices.size();
  counts.file_triangles = mesh.triangles.size();
  counts.file_tetrahedra = import.tetrahedra.size();
  counts.warnings = std::move(import.notes);
  mesh.vertices = std::move(import.vertices);
  mesh.tetrahedra = std::move(import.tetrahedra);
  place(mesh, unit * options.scale, options.up.empty() ? import.up : options.up.front());
  if (const std::size_t merged = weld(mesh); merged > 0)
    counts.repairs.push_back(fmt::format("welded {} vertices at equal positions", merged));
  repair(mesh, counts);

  MeshReport& report = loaded.report;
  report = inspect(mesh);
  report.format = counts.format;
  report.file_vertices = counts.file_vertices;
  report.file_triangles = counts.file_triangles;
  report.file_tetrahedra = counts.file_tetrahedra;
  report.degenerate_triangles = counts.degenerate_triangles;
  report.duplicate_triangles = counts.duplicate_triangles;
  report.degenerate_tetrahedra = counts.degenerate_tetrahedra;
  report.duplicate_tetrahedra = counts.duplicate_tetrahedra;
  report.inverted_tetrahedra = counts.inverted_tetrahedra;
  report.repairs = std::move(counts.repairs);
  report.warnings = std::move(counts.warnings);
  add_warnings(report);
  return loaded;
}

LoadedMesh load_mesh(const std::filesystem::path& path, const LoadOptions& options) {
  const std::string bytes = detail::read_bytes(path);
  return read_mesh(path, bytes, options);
}

}  // namespace gotai::geometry
