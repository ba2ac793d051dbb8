#include "gotai/scene/scene_file.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "gotai/scene/readers.h"

namespace gotai::scene {
namespace {

std::string read_whole_file(const std::string& path) {
  constexpr std::uintmax_t kLargest = 64u << 20;
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) throw FileError(path, "is a folder, not a scene");
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) throw FileError(path, "cannot be read: " + error.message());
  if (size > kLargest)
    throw FileError(path, "is larger than 64 MiB; many bodies go into a pose file");
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) throw FileError(path, "cannot be read");
  return std::move(text).str();
}

}  // namespace

namespace detail {

std::string resolve(const SceneDescription& scene, const std::string& path) {
  const std::filesystem::path given(path);
  if (given.is_absolute()) return path;
  return (std::filesystem::path(scene.path).parent_path() / given).lexically_normal().string();
}

}  // namespace detail

SceneDescription load_scene(const std::string& path, const std::vector<std::string>& overrides) {
  return parse_scene(read_whole_file(path), path, overrides);
}

SceneDescription parse_scene(std::string text, const std::string& path,
                             const std::vector<std::string>& overrides) {
  Node document = parse_document(text, path);
  for (const std::string& assignment : overrides) apply_override(document, assignment);

  SceneDescription scene;
  scene.path = path;
  scene.text = std::move(text);
  scene.overrides = overrides;
  TableReader table(document, "the scene");
  // Settings first: shapes are prepared for the level; materials before what names them.
  detail::read_settings(table, scene);
  detail::read_materials(table, scene);
  detail::read_shapes(table, scene);
  detail::read_surroundings(table, scene);
  detail::read_bodies(table, scene);
  detail::read_pours(table, scene);
  table.finish();
  if (scene.bodies.empty() && scene.pours.empty()) {
    throw FileError(path, "the scene has no bodies; add [[bodies]] or [[pour]]");
  }
  try {
    model::validate(scene.settings);
    model::validate(scene.materials);
  } catch (const InvalidArgument& error) {
    throw FileError(path, error.what());
  }
  return scene;
}

}  // namespace gotai::scene
