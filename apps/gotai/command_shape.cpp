#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "commands.h"
#include "console.h"
#include "exit_code.h"
#include "gotai/core/stopwatch.h"
#include "gotai/geometry/generate.h"
#include "gotai/geometry/load_mesh.h"
#include "gotai/scene/build_world.h"
#include "gotai/voxel/shape_file.h"
#include "output_file.h"
#include "shape_text.h"

namespace gotai::cli {
namespace {

constexpr const char* kShapeFooter = R"(Examples:
  gotai shape part.stl -o part.gotai-shape --unit mm
  gotai shape spot.obj -o spot.gotai-shape --up y --size 0.3 --level 8
  gotai shape --generate rock --seed 7 -o rock.gotai-shape
Scenes prepare their shapes themselves and keep them in a cache; this command shows what comes out:
mass properties and surface voxels of every level.)";

struct ShapeOptions {
  scene::ShapeDescription shape;
  std::string output;
  bool force = false;
  bool json = false;
};

int make_shape(ShapeOptions options) {
  require_free(options.output, options.force);
  scene::ShapeDescription& shape = options.shape;
  shape.where.file = shape.mesh_path;
  shape.name = shape.mesh_path.empty() ? shape.generator.shape
                                       : std::filesystem::path(shape.mesh_path).stem().string();

  shape.generator.size = shape.size;
  const Stopwatch watch;
  scene::PreparedShape prepared = scene::prepare_shape(shape);
  const double seconds = watch.seconds();
  voxel::write_shape(options.output, prepared.shape);
  prepared.shape.warnings = prepared.warnings;  // shown with those of the mesh
  if (options.json) {
    nlohmann::ordered_json json = to_json(prepared.shape);
    json["repairs"] = prepared.repairs;
    json["prepared_s"] = seconds;
    print(json.dump() + "\n");
    return kSuccess;
  }
  Report report;
  describe(prepared.shape, report);
  for (const std::string& repair : prepared.repairs) report.row("repaired", repair);
  report.row("prepared in", format_duration(seconds));
  print(report.text() + fmt::format("written to {}\n", options.output));
  return kSuccess;
}

}  // namespace

void add_shape_command(CLI::App& app, Action& action) {
  auto options = std::make_shared<ShapeOptions>();
  options->shape.prepared_level = voxel::ShapeOptions{}.prepared_level;
  options->shape.surface_level = voxel::ShapeOptions{}.surface_level;
  scene::ShapeDescription& shape = options->shape;
  CLI::App* command = app.add_subcommand("shape", "Prepare a shape from a mesh and show it");
  command->footer(kShapeFooter);
  CLI::Option_group* source = command->add_option_group("source");
  source->add_option("MESH", shape.mesh_path, "Mesh file, recognised by its content");
  source->add_option("--generate", shape.generator.shape, "A generated shape instead of a file")
      ->check(CLI::IsMember(geometry::generator_names()));
  source->require_option(1);
  command->add_option("-o,--output", options->output, "Shape file to write")
      ->type_name("OUT.gotai-shape")
      ->required();
  command
      ->add_option("--level", shape.prepared_level,
                   "Finest level M: 2^(M-1) voxels along the longest side")
      ->check(CLI::Range(1, voxel::kMaxLevel))
      ->capture_default_str();
  command
      ->add_option("--surface-level", shape.surface_level,
                   "Level at which the true surface is sampled, 3..8; 0: voxels alone")
      ->check(CLI::Range(voxel::kMinSurfaceLevel, voxel::kMaxSurfaceLevel) | CLI::IsMember({0}))
      ->capture_default_str();
  command
      ->add_option("--accuracy", shape.accuracy,
                   "Wish, a fraction of the largest extent (0.001): the surface level rises until "
                   "walls are a voxel thick and the surface is off by less")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--unit", shape.load.unit, "Length unit of the file")
      ->check(CLI::IsMember(geometry::length_unit_names()))
      ->capture_default_str();
  command->add_option("--up", shape.load.up, "Axis of the file that points up")
      ->check(CLI::IsMember({"x", "y", "z"}));
  command->add_option("--scale", shape.load.scale, "Further factor on all lengths")
      ->check(CLI::PositiveNumber);
  command->add_option("--size", shape.size, "Largest extent [m]; default: as in the file")
      ->check(CLI::PositiveNumber);
  command
      ->add_option(
          "--thickness", shape.thickness,
          "Make a solid of an open sheet, this thick [m]; a closed surface becomes a shell")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--seed", shape.generator.seed, "Seed of a generated rock");
  command->add_flag("--force", options->force, "Overwrite an existing output");
  command->add_flag("--json", options->json, "Print one JSON object on standard output");
  command->callback([options, &action] { action = [options] { return make_shape(*options); }; });
}

}  // namespace gotai::cli
