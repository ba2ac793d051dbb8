#include "shape_text.h"

#include <fmt/format.h>

#include "gotai/geometry/mass_properties.h"

namespace gotai::cli {
namespace {

nlohmann::ordered_json array(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

std::string metres(const Vec3& v) {
  return fmt::format("{:.5g} {:.5g} {:.5g} m", v.x(), v.y(), v.z());
}

// The counts that are not zero, in words.
std::string list_defects(const geometry::MeshReport& mesh) {
  const std::pair<std::size_t, const char*> defects[] = {
      {mesh.boundary_edges, "open edges"},
      {mesh.non_manifold_edges, "edges with three or more faces"},
      {mesh.misoriented_edges, "edges between faces of opposite orientation"},
      {mesh.degenerate_triangles, "degenerate triangles"},
      {mesh.duplicate_triangles, "duplicate triangles"},
      {mesh.degenerate_tetrahedra, "degenerate tetrahedra"},
      {mesh.duplicate_tetrahedra, "duplicate tetrahedra"},
      {mesh.inverted_tetrahedra, "inverted tetrahedra"},
  };
  std::string text;
  for (const auto& [count, name] : defects) {
    if (count == 0) continue;
    if (!text.empty()) text += ", ";
    text += fmt::format("{} {}", format_count(count), name);
  }
  return text.empty() ? "none" : text;
}

}  // namespace

nlohmann::ordered_json to_json(const geometry::MeshReport& mesh) {
  return {
      {"kind", "mesh"},
      {"format", mesh.format},
      {"vertices", mesh.vertices},
      {"triangles", mesh.triangles},
      {"tetrahedra", mesh.tetrahedra},
      {"components", mesh.components},
      {"extents", array(mesh.extents)},
      {"volume", mesh.volume},
      {"closed", mesh.closed},
      {"oriented", mesh.oriented},
      {"solid", mesh.is_solid()},
      {"defects",
       {{"boundary_edges", mesh.boundary_edges},
        {"non_manifold_edges", mesh.non_manifold_edges},
        {"misoriented_edges", mesh.misoriented_edges},
        {"degenerate_triangles", mesh.degenerate_triangles},
        {"duplicate_triangles", mesh.duplicate_triangles},
        {"degenerate_tetrahedra", mesh.degenerate_tetrahedra},
        {"duplicate_tetrahedra", mesh.duplicate_tetrahedra},
        {"inverted_tetrahedra", mesh.inverted_tetrahedra}}},
      {"repairs", mesh.repairs},
      {"warnings", mesh.warnings},
  };
}

nlohmann::ordered_json to_json(const voxel::Shape& shape) {
  const geometry::PrincipalAxes axes = geometry::principal_axes(shape.mass.inertia);
  nlohmann::ordered_json json = {
      {"kind", "shape"},
      {"name", shape.name},
      {"vertices", shape.mesh.vertices.size()},
      {"triangles", shape.mesh.triangles.size()},
      {"tetrahedra", shape.mesh.tetrahedra.size()},
      {"extents", array(geometry::bounding_box(shape.mesh).sizes())},
      {"volume", shape.mass.volume},
      {"volume_error", shape.volume_error},
      {"warnings", shape.warnings},
      {"center_of_mass", array(shape.mass.center_of_mass)},
      {"principal_moments_at_density_1", array(axes.moments)},
      {"bounding_radius", shape.bounding_radius},
      {"content", shape.content.hex()},
      {"levels", nlohmann::ordered_json::array()},
  };
  for (int h = 1; h <= shape.pyramid.max_level(); ++h) {
    json["levels"].push_back({{"level", h},
                              {"voxel_edge", shape.pyramid.grid.voxel_edge(h)},
                              {"voxels", shape.pyramid.level(h).size()}});
  }
  if (!shape.surface.empty()) {
    json["surface"] = {{"level", shape.surface.level},
                       {"samples", shape.surface.tree.size()},
                       {"spacing", shape.surface.spacing},
                       {"bytes", shape.surface.bytes()}};
  }
  return json;
}

void describe(const geometry::MeshReport& mesh, Report& report) {
  report.row("format", mesh.format);
  report.row("elements", fmt::format("{} vertices, {} triangles, {} tetrahedra in {} pieces",
                                     format_count(mesh.vertices), format_count(mesh.triangles),
                                     format_count(mesh.tetrahedra), format_count(mesh.components)));
  report.row("extents", metres(mesh.extents));
  report.row("volume", fmt::format("{:.6g} m^3", mesh.volume));
  report.row("surface", fmt::format("{}, {}", mesh.closed ? "closed" : "not closed",
                                    mesh.oriented ? "oriented" : "not oriented"));
  report.row("defects", list_defects(mesh));
  for (const std::string& repair : mesh.repairs) report.row("repaired", repair);
  for (const std::string& warning : mesh.warnings) report.row("warning", warning);
  report.row("usable", mesh.is_solid()
                           ? "yes"
                           : "where it encloses a body: prepare it to see; a sheet needs "
                             "a thickness");
}

void describe(const voxel::Shape& shape, Report& report) {
  const geometry::PrincipalAxes axes = geometry::principal_axes(shape.mass.inertia);
  report.row("name", shape.name);
  report.row("elements", fmt::format("{} vertices, {} triangles, {} tetrahedra",
                                     format_count(shape.mesh.vertices.size()),
                                     format_count(shape.mesh.triangles.size()),
                                     format_count(shape.mesh.tetrahedra.size())));
  report.row("extents", metres(geometry::bounding_box(shape.mesh).sizes()));
  report.row("volume", fmt::format("{:.6g} m^3", shape.mass.volume));
  report.row("centre of mass", metres(shape.mass.center_of_mass));
  report.row("principal moments",
             fmt::format("{:.5g} {:.5g} {:.5g} kg m^2 at 1000 kg/m^3", 1e3 * axes.moments.x(),
                         1e3 * axes.moments.y(), 1e3 * axes.moments.z()));
  for (const std::string& warning : shape.warnings) report.row("warning", warning);
  if (!shape.surface.empty()) {
    report.row("surface", fmt::format("level {}: {} samples {} apart, {} KB", shape.surface.level,
                                      format_count(shape.surface.tree.size()),
                                      format_length(shape.surface.spacing),
                                      format_count(shape.surface.bytes() / 1000)));
  }
  report.row("content", shape.content.hex());
  for (int h = 1; h <= shape.pyramid.max_level(); ++h) {
    report.row(
        fmt::format("level {}", h),
        fmt::format("{:>9} surface voxels of {}", format_count(shape.pyramid.level(h).size()),
                    format_length(shape.pyramid.grid.voxel_edge(h))));
  }
}

}  // namespace gotai::cli
