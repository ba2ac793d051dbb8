/// @file
/// The parts of the scene reader, one per group of tables. Internal to the module.
#pragma once

#include <string>

#include "gotai/core/error.h"
#include "gotai/scene/description.h"
#include "gotai/scene/table_reader.h"

namespace gotai::scene::detail {

/// [world], [collision], [impulse], [time], [record].
void read_settings(TableReader& document, SceneDescription& scene);

/// [material], [materials.NAME], [[material_pair]].
void read_materials(TableReader& document, SceneDescription& scene);

/// `material = "name"`, or a table of its own that starts from [material].
/// @returns nothing when the key is absent
std::optional<std::uint32_t> read_material(TableReader& table, SceneDescription& scene);

/// [shapes.NAME].
void read_shapes(TableReader& document, SceneDescription& scene);
/// `shape = "name"`. @throws FileError with the nearest name
std::uint32_t read_shape_name(const Node& node, const SceneDescription& scene);

/// [[plane]], [[container]].
void read_surroundings(TableReader& document, SceneDescription& scene);
/// [[bodies]].
void read_bodies(TableReader& document, SceneDescription& scene);
/// [[pour]].
void read_pours(TableReader& document, SceneDescription& scene);

/// A rotation: { axis = [x, y, z], degrees = a } or { quaternion = [w, x, y, z] }.
Quat read_rotation(const Node& node);
/// `mass` or `density`, not both.
void read_mass(TableReader& table, std::optional<double>& mass, std::optional<double>& density);
/// A path relative to the scene's folder.
std::string resolve(const SceneDescription& scene, const std::string& path);

/// A name of an enumeration.
/// @param parse  throws InvalidArgument listing the allowed names
template <typename T, typename Parse>
T read_choice(TableReader& table, std::string_view key, T fallback, const Parse& parse) {
  const Node* node = table.find(key);
  if (node == nullptr) return fallback;
  const std::string& text = read_text(*node, key);
  try {
    return parse(text);
  } catch (const InvalidArgument& error) {
    fail(node->where, error.what());
  }
}

/// Calls read(node, number counted from 0) for every element of an array of tables; nothing when
/// the key is absent.
template <typename Read>
void for_each_table(TableReader& document, std::string_view key, const Read& read) {
  const Node* node = document.find(key);
  if (node == nullptr) return;
  std::size_t number = 0;
  for (const Node& element : read_array(*node, key)) read(element, number++);
}

}  // namespace gotai::scene::detail
