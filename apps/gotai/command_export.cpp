#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "console.h"
#include "exit_code.h"
#include "gotai/recording/export.h"
#include "output_file.h"

namespace gotai::cli {
namespace {

constexpr const char* kExportFooter = R"(Examples:
  gotai export run.h5 -o run.glb      animated glTF: Blender, three.js, Windows 3D Viewer
  gotai export run.h5 -o run.csv      time,body,px,py,pz,qw,qx,qy,qz of the meshes' own frames
  gotai export run.h5 -o run.pvd      ParaView: one file per frame, with velocities and contacts
The extension chooses the format. glTF is y-up: a root node turns the scene.)";

struct ExportOptions {
  std::string recording;
  std::string output;
  bool force = false;
  bool json = false;
};

int export_file(const ExportOptions& options) {
  require_free(options.output, options.force);
  const recording::RecordingReader run(options.recording);
  recording::export_recording(run, options.output);
  const std::uint64_t bytes = std::filesystem::file_size(options.output);
  if (options.json) {
    print(nlohmann::ordered_json(
              {{"output", options.output}, {"frames", run.frame_count()}, {"bytes", bytes}})
              .dump() +
          "\n");
  } else {
    print(fmt::format("{} frames to {} ({})\n", format_count(run.frame_count()), options.output,
                      format_bytes(bytes)));
  }
  return kSuccess;
}

}  // namespace

void add_export_command(CLI::App& app, Action& action) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* command =
      app.add_subcommand("export", "Turn a recording into animated glTF, CSV or ParaView files");
  command->footer(kExportFooter);
  command->add_option("RUN.h5", options->recording, "Recording")->required();
  command->add_option("-o,--output", options->output, "File to write")
      ->type_name("OUT.glb|csv|pvd")
      ->required();
  command->add_flag("--force", options->force, "Overwrite an existing output");
  command->add_flag("--json", options->json, "Print one JSON object on standard output");
  command->callback([options, &action] { action = [options] { return export_file(*options); }; });
}

}  // namespace gotai::cli
