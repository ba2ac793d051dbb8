#include "gotai/view/run_header.h"

#include <fmt/format.h>

namespace gotai::view {
namespace {

using nlohmann::json;

// Voxels of all levels of all shapes together; finer levels beyond it are left out.
constexpr std::size_t kMostVoxels = 1'000'000;

json to_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

const char* to_text(model::BodyKind kind) {
  switch (kind) {
    case model::BodyKind::dynamic:
      return "dynamic";
    case model::BodyKind::fixed:
      return "fixed";
    case model::BodyKind::kinematic:
      return "kinematic";
  }
  return "";
}

const char* to_text(model::Geometry geometry) {
  switch (geometry) {
    case model::Geometry::shape:
      return "shape";
    case model::Geometry::plane:
      return "plane";
    case model::Geometry::container:
      return "container";
  }
  return "";
}

void add_mesh(const geometry::Mesh& mesh, const std::string& name, ContainerWriter& container) {
  // Only the vertices of the surface: those inside are never seen.
  constexpr auto kUnused = std::uint32_t(-1);
  std::vector<std::uint32_t> place(mesh.vertices.size(), kUnused);
  std::vector<float> vertices;
  std::vector<std::uint32_t> triangles;
  for (const geometry::Triangle& triangle : mesh.triangles)
    for (const std::uint32_t vertex : triangle) {
      if (place[vertex] == kUnused) {
        place[vertex] = static_cast<std::uint32_t>(vertices.size() / 3);
        for (int k = 0; k < 3; ++k)
          vertices.push_back(static_cast<float>(mesh.vertices[vertex][k]));
      }
      triangles.push_back(place[vertex]);
    }
  container.add(name + ".vertices", vertices);
  container.add(name + ".triangles", triangles);
}

void add_level(const std::vector<std::array<std::uint16_t, 3>>& voxels, const std::string& name,
               ContainerWriter& container) {
  std::vector<std::uint8_t> index;
  index.reserve(3 * voxels.size());
  for (const auto& voxel : voxels)
    for (const std::uint16_t i : voxel) index.push_back(static_cast<std::uint8_t>(i));
  container.add(name, index, 3);
}

}  // namespace

json write_run_header(const RunView& run, ContainerWriter& container,
                      std::vector<std::string>& notes) {
  json header{{"format", "gotai-view"},     {"version", 1},
              {"title", run.title},         {"generator", run.generator},
              {"facts", run.facts},         {"gravity", to_json(run.gravity)},
              {"level", run.level},         {"shapes", json::array()},
              {"materials", json::array()}, {"bodies", json::array()},
              {"series", json::array()}};
  std::size_t voxels = 0;
  for (std::size_t s = 0; s < run.shapes.size(); ++s) {
    const ShapeView& shape = run.shapes[s];
    const std::string name = fmt::format("shape{}", s);
    add_mesh(*shape.mesh, name, container);
    json levels = json::array();
    for (std::size_t level = 1; level <= shape.voxels.size(); ++level) {
      const auto& content = shape.voxels[level - 1];
      if (voxels + content.size() > kMostVoxels) {
        notes.push_back(
            fmt::format("Voxels of {} from level {} on are left out.", shape.name, level));
        break;
      }
      voxels += content.size();
      add_level(content, fmt::format("{}.level{}", name, level), container);
      levels.push_back(level);
    }
    header["shapes"].push_back(
        {{"name", shape.name},
         {"com", to_json(shape.center_of_mass)},
         {"grid", {{"origin", to_json(shape.grid.origin)}, {"edge", shape.grid.edge}}},
         {"levels", levels}});
  }
  for (const model::Material& material : run.materials)
    header["materials"].push_back({{"name", material.name},
                                   {"restitution", material.restitution},
                                   {"friction", material.friction}});
  for (const BodyView& body : run.bodies) {
    json entry{
        {"name", body.name},    {"kind", to_text(body.kind)}, {"geometry", to_text(body.geometry)},
        {"shape", body.shape},  {"material", body.material},  {"mass", body.mass},
        {"radius", body.radius}};
    if (body.geometry == model::Geometry::container) entry["extent"] = to_json(body.half_extent);
    header["bodies"].push_back(std::move(entry));
  }
  for (const Curve& curve : curves())
    header["series"].push_back({{"name", curve.name},
                                {"label", curve.label},
                                {"unit", curve.unit},
                                {"chart", curve.chart}});
  return header;
}

}  // namespace gotai::view
