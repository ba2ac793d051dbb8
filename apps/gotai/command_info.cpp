#include <filesystem>
#include <fstream>
#include <memory>

#include "commands.h"
#include "console.h"
#include "exit_code.h"
#include "gotai/core/error.h"
#include "gotai/geometry/load_mesh.h"
#include "gotai/voxel/shape_file.h"
#include "recording_text.h"
#include "shape_text.h"

namespace gotai::cli {
namespace {

constexpr const char* kInfoFooter = R"(Examples:
  gotai info part.stl                 elements, extents, volume, defects
  gotai info part.gotai-shape         mass properties and voxels per level
  gotai info run.h5 --json            bodies, frames, the run's figures
The kind of file is recognised by its content.)";

struct InfoOptions {
  std::string path;
  bool json = false;
};

bool is_recording(const std::string& path) {
  static const std::string kSignature = "\x89HDF\r\n\x1a\n";
  std::string start(kSignature.size(), '\0');
  std::ifstream in(path, std::ios::binary);
  in.read(start.data(), static_cast<std::streamsize>(start.size()));
  return in && start == kSignature;
}

template <typename Described>
int show(const Described& described, bool json) {
  if (json) {
    print(to_json(described).dump() + "\n");
  } else {
    Report report;
    describe(described, report);
    print(report.text());
  }
  return kSuccess;
}

int show_info(const InfoOptions& options) {
  if (!std::filesystem::exists(options.path)) {
    throw FileError(options.path, "does not exist");
  }
  if (is_recording(options.path)) {
    return show(recording::RecordingReader(options.path), options.json);
  }
  if (voxel::is_shape_file(options.path)) {
    return show(voxel::read_shape(options.path), options.json);
  }
  return show(geometry::load_mesh(options.path).report, options.json);
}

}  // namespace

void add_info_command(CLI::App& app, Action& action) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* command =
      app.add_subcommand("info", "Say what is in a mesh, a prepared shape or a recording");
  command->footer(kInfoFooter);
  command->add_option("FILE", options->path, "Mesh, shape file or recording")->required();
  command->add_flag("--json", options->json, "Print one JSON object on standard output");
  command->callback([options, &action] { action = [options] { return show_info(*options); }; });
}

}  // namespace gotai::cli
