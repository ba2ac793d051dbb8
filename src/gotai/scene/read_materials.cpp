#include <fmt/format.h>

#include <algorithm>

#include "gotai/scene/readers.h"
#include "gotai/scene/suggest.h"

namespace gotai::scene::detail {
namespace {

/// Reads a material's keys; those that are absent keep the values of `base`.
model::Material read_material_table(const Node& node, const std::string& title,
                                    model::Material base) {
  TableReader table(node, title);
  base.restitution = table.number("restitution", base.restitution, range::unit);
  base.friction = table.number("friction", base.friction, range::non_negative);
  base.density = table.number("density", base.density, range::positive);
  table.finish();
  return base;
}

std::uint32_t find_material(const Node& node, const SceneDescription& scene) {
  const std::string& name = read_text(node, "material");
  std::vector<std::string> names;
  for (std::size_t i = 0; i < scene.materials.materials.size(); ++i) {
    if (scene.materials.materials[i].name == name) return static_cast<std::uint32_t>(i);
    names.push_back(scene.materials.materials[i].name);
  }
  fail(node.where, fmt::format("there is no material \"{}\"{}", name, suggestion(name, names)));
}

void read_pair(const Node& node, SceneDescription& scene) {
  TableReader table(node, "[[material_pair]]");
  const Node& names = table.require("materials");
  const Node::Array* array = names.array();
  if (array == nullptr || array->size() != 2) {
    fail(names.where, "materials must name two materials, for example [\"steel\", \"wood\"]");
  }
  const std::uint32_t a = find_material((*array)[0], scene);
  const std::uint32_t b = find_material((*array)[1], scene);
  model::SurfacePair pair = scene.materials.combine(a, b);
  pair.restitution = table.number("restitution", pair.restitution, range::unit);
  pair.friction = table.number("friction", pair.friction, range::non_negative);
  table.finish();
  if (!scene.materials.overrides.emplace(std::minmax(a, b), pair).second) {
    fail(node.where, "this pair of materials was set before");
  }
}

}  // namespace

void read_materials(TableReader& document, SceneDescription& scene) {
  auto& materials = scene.materials.materials;
  if (const Node* node = document.find("material")) {
    materials[0] = read_material_table(*node, "[material]", materials[0]);
  }
  if (const Node* node = document.find("materials")) {
    TableReader table(*node, "[materials]");
    for (const Entry& entry : *node->table()) {
      table.find(entry.key);
      if (entry.key == materials[0].name) {
        fail(entry.where, fmt::format("\"{}\" is the name of [material]", entry.key));
      }
      materials.push_back(
          read_material_table(entry.value, fmt::format("[materials.{}]", entry.key), materials[0]));
      materials.back().name = entry.key;
    }
  }
  for_each_table(document, "material_pair",
                 [&](const Node& node, std::size_t) { read_pair(node, scene); });
}

std::optional<std::uint32_t> read_material(TableReader& table, SceneDescription& scene) {
  const Node* node = table.find("material");
  if (node == nullptr) return std::nullopt;
  if (node->table() == nullptr) return find_material(*node, scene);
  auto& materials = scene.materials.materials;
  materials.push_back(
      read_material_table(*node, "the material of " + table.title(), materials.front()));
  materials.back().name = fmt::format("material {}", materials.size() - 1);
  return static_cast<std::uint32_t>(materials.size() - 1);
}

}  // namespace gotai::scene::detail
