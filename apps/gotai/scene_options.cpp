#include "scene_options.h"

#include <utility>

#include "console.h"
#include "gotai/voxel/shape_cache.h"

namespace gotai::cli {

void add_scene_options(CLI::App& command, SceneOptions& options) {
  command.add_option("SCENE", options.path, "Scene file (TOML)")->required();
  command
      .add_option("--set", options.overrides,
                  "Override a key of the scene, for example --set impulse.method=penalty "
                  "(again for more keys)")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  command.add_option("--threads", options.threads, "Number of threads (default: all processors)")
      ->check(CLI::Range(1, 1024));
  command.add_flag("--json", options.json, "Print one JSON object on standard output");
}

OpenedScene open_scene(const SceneOptions& options, bool refuse_overlaps) {
  return build_scene(scene::load_scene(options.path, options.overrides), refuse_overlaps);
}

OpenedScene build_scene(scene::SceneDescription description, bool refuse_overlaps) {
  OpenedScene opened;
  opened.description = std::move(description);
  ProgressLine progress;
  scene::BuildOptions build;
  build.cache_folder = voxel::default_cache_folder();
  build.progress = [&progress](const std::string& text) { progress.show(text); };
  build.refuse_overlaps = refuse_overlaps;
  opened.built = scene::build_world(opened.description, build);
  return opened;
}

}  // namespace gotai::cli
