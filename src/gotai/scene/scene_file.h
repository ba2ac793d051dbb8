/// @file
/// Scene files: TOML text -> SceneDescription.
#pragma once

#include <string>
#include <vector>

#include "gotai/scene/description.h"

namespace gotai::scene {

/// Reads a scene file. docs/scenes.md lists every key.
/// @param overrides  assignments "dotted.key=value", applied in order before reading
/// @throws FileError with file, line and column for anything that is not a valid scene: bad TOML,
///         unknown or misspelt keys (with the nearest one), wrong types, impossible values
SceneDescription load_scene(const std::string& path,
                            const std::vector<std::string>& overrides = {});

/// The same for text in memory.
/// @param path  for messages and as the base of relative paths
SceneDescription parse_scene(std::string text, const std::string& path,
                             const std::vector<std::string>& overrides = {});

}  // namespace gotai::scene
