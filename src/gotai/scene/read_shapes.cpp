#include <fmt/format.h>

#include <algorithm>

#include "gotai/scene/readers.h"
#include "gotai/scene/suggest.h"
#include "gotai/voxel/shape.h"

namespace gotai::scene::detail {
namespace {

/// A text that must be one of a few.
std::string read_one_of(TableReader& table, std::string_view key, const std::string& fallback,
                        const std::vector<std::string>& allowed) {
  const Node* node = table.find(key);
  if (node == nullptr) return fallback;
  const std::string& text = read_text(*node, key);
  if (std::find(allowed.begin(), allowed.end(), text) == allowed.end()) {
    fail(node->where,
         fmt::format("{} = \"{}\" is not known{}", key, text, suggestion(text, allowed)));
  }
  return text;
}

void read_generator(TableReader& table, ShapeDescription& shape) {
  const Range below_one{0.0, 1.0 - 1e-9, "must be >= 0 and < 1"};
  geometry::GeneratorOptions& options = shape.generator;
  options.shape = read_one_of(table, "generate", "", geometry::generator_names());
  options.size = shape.size;
  options.subdivisions = static_cast<int>(table.integer("subdivisions", 0, 0, 100));
  if (options.shape == "box") options.extents = table.vector("extents", options.extents);
  if (options.shape == "rock") {
    options.seed = static_cast<std::uint64_t>(table.integer("seed", 1, 0, INT64_MAX));
    options.roughness = table.number("roughness", options.roughness, below_one);
  }
  if (options.shape == "torus" || options.shape == "cylinder" || options.shape == "disc") {
    options.thickness = table.number("thickness", 0.0, range::non_negative);
  }
}

ShapeDescription read_shape(const Entry& entry, SceneDescription& scene) {
  ShapeDescription shape;
  shape.name = entry.key;
  shape.where = entry.where;
  TableReader table(entry.value, fmt::format("[shapes.{}]", entry.key));
  shape.size = table.number("size", 0.0, range::positive);
  shape.prepared_level = static_cast<int>(table.integer("prepared_level", 0, 1, voxel::kMaxLevel));
  if (shape.prepared_level == 0) {
    shape.prepared_level =
        std::max(voxel::ShapeOptions{}.prepared_level, scene.settings.collision.level);
  } else if (shape.prepared_level < scene.settings.collision.level) {
    fail(table.find("prepared_level")->where,
         fmt::format("prepared_level = {} is coarser than the level {} of [collision]: prepare to "
                     "at least that level",
                     shape.prepared_level, scene.settings.collision.level));
  }
  const bool needs_surface = scene.settings.collision.model == model::CollisionModel::surface;
  const int surface_level =
      std::clamp(scene.settings.collision.level, voxel::kMinSurfaceLevel, voxel::kMaxSurfaceLevel);
  shape.surface_level =
      static_cast<int>(table.integer("surface_level", needs_surface ? surface_level : 0,
                                     voxel::kMinSurfaceLevel, voxel::kMaxSurfaceLevel));
  shape.accuracy = table.number("accuracy", 0.0, range::non_negative);
  shape.material = read_material(table, scene).value_or(0);
  const Node* mesh = table.find("mesh");
  const Node* generator = table.find("generate");
  if ((mesh == nullptr) == (generator == nullptr)) {
    fail(entry.where,
         fmt::format("{} needs either mesh = \"file\" or generate = \"name\"", table.title()));
  }
  if (mesh != nullptr) {
    shape.mesh_path = resolve(scene, read_text(*mesh, "mesh"));
    shape.load.unit = read_one_of(table, "unit", shape.load.unit, geometry::length_unit_names());
    shape.load.up = read_one_of(table, "up", shape.load.up, {"x", "y", "z"});
    shape.load.scale = table.number("scale", shape.load.scale, range::positive);
    shape.thickness = table.number("thickness", 0.0, range::non_negative);
  } else {
    read_generator(table, shape);
  }
  table.finish();
  return shape;
}

}  // namespace

void read_shapes(TableReader& document, SceneDescription& scene) {
  const Node* node = document.find("shapes");
  if (node == nullptr) return;
  TableReader table(*node, "[shapes]");
  for (const Entry& entry : *node->table()) scene.shapes.push_back(read_shape(entry, scene));
}

std::uint32_t read_shape_name(const Node& node, const SceneDescription& scene) {
  const std::string& name = read_text(node, "shape");
  std::vector<std::string> names;
  for (std::size_t i = 0; i < scene.shapes.size(); ++i) {
    if (scene.shapes[i].name == name) return static_cast<std::uint32_t>(i);
    names.push_back(scene.shapes[i].name);
  }
  if (names.empty())
    fail(node.where, fmt::format("there is no shape \"{0}\"; add [shapes.{0}]", name));
  fail(node.where, fmt::format("there is no shape \"{}\"{}", name, suggestion(name, names)));
}

}  // namespace gotai::scene::detail
