/// @file
/// What all commands that read a scene have in common.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "gotai/scene/build_world.h"
#include "gotai/scene/scene_file.h"

namespace gotai::cli {

struct SceneOptions {
  std::string path;
  std::vector<std::string> overrides;  ///< of --set
  int threads = 0;                     ///< 0: all processors
  bool json = false;
};

/// Adds SCENE, --set, --threads and --json to a command.
void add_scene_options(CLI::App& command, SceneOptions& options);

/// Reads the scene and builds its world, with a progress line while shapes are prepared.
struct OpenedScene {
  scene::SceneDescription description;
  scene::BuiltScene built;
};
OpenedScene open_scene(const SceneOptions& options, bool refuse_overlaps);
/// The second half of open_scene.
OpenedScene build_scene(scene::SceneDescription description, bool refuse_overlaps);

}  // namespace gotai::cli
