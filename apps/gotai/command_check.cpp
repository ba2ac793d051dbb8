#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "console.h"
#include "exit_code.h"
#include "gotai/core/parallel.h"
#include "gotai/core/stopwatch.h"
#include "gotai/dynamics/step_control.h"
#include "scene_options.h"

namespace gotai::cli {
namespace {

constexpr const char* kCheckFooter = R"(Examples:
  gotai check scene.toml
  gotai check scene.toml --set collision.level=5 --json
Exit code 0: the scene can be run. Initial overlaps beyond one voxel count as an error (exit code 1)
unless the scene says world.allow_initial_overlap = true.)";

constexpr double kTrialSeconds = 2.0;  // wall time of the trial run
constexpr std::size_t kListedOverlaps = 10;

// What `gotai check` finds out.
struct Findings {
  double first_step = 0.0;  // [s]
  std::uint64_t steps = 0;  // expected, whole run
  double wall_s = 0.0;      // expected, whole run, without preparation
  double preparation_s = 0.0;
  double trial_s = 0.0;  // simulated by the trial
  std::uint64_t memory_bytes = 0;
  std::uint64_t frames = 0;
};

std::uint64_t peak_memory() {
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

// Runs the beginning of the scene for a moment and extrapolates.
void measure_trial(World& world, double duration, Findings& findings) {
  const Stopwatch watch;
  std::uint64_t steps = 0;
  while (!world.has_reached(duration) && watch.seconds() < kTrialSeconds) {
    world.step();
    ++steps;
  }
  const double scale = world.time() > 0.0 ? std::max(1.0, duration / world.time()) : 0.0;
  findings.trial_s = std::min(world.time(), duration);
  findings.steps = static_cast<std::uint64_t>(static_cast<double>(steps) * scale);
  findings.wall_s = watch.seconds() * scale;
  findings.memory_bytes = peak_memory();
}

std::uint64_t count_kind(const model::BodyState& bodies, model::BodyKind kind) {
  std::uint64_t count = 0;
  for (model::BodyIndex i = 0; i < bodies.size(); ++i) {
    count += bodies.geometry[i] == model::Geometry::shape && bodies.kind[i] == kind ? 1U : 0U;
  }
  return count;
}

nlohmann::ordered_json findings_json(const OpenedScene& scene, const Findings& findings) {
  const model::BodyState& bodies = scene.built.world->bodies();
  nlohmann::ordered_json json = {
      {"scene", scene.description.path},
      {"dynamic", count_kind(bodies, model::BodyKind::dynamic)},
      {"fixed", count_kind(bodies, model::BodyKind::fixed)},
      {"kinematic", count_kind(bodies, model::BodyKind::kinematic)},
      {"shapes", scene.built.world->shapes().size()},
      {"duration_s", scene.description.duration},
      {"step_s", findings.first_step},
      {"step_derived", scene.description.settings.time.step == 0.0},
      {"expected_steps", findings.steps},
      {"expected_wall_s", findings.wall_s},
      {"preparation_s", findings.preparation_s},
      {"memory_bytes", findings.memory_bytes},
      {"frames", findings.frames},
      {"repairs", scene.built.repairs},
      {"warnings", scene.built.warnings},
      {"overlaps", nlohmann::ordered_json::array()},
  };
  for (const scene::InitialOverlap& overlap : scene.built.overlaps) {
    json["overlaps"].push_back({{"body_a", overlap.body_a},
                                {"body_b", overlap.body_b},
                                {"depth", overlap.depth},
                                {"voxel_edge", overlap.voxel_edge},
                                {"refused", overlap.is_refused()}});
  }
  return json;
}

std::string to_text(const OpenedScene& scene, const Findings& findings) {
  const World& world = *scene.built.world;
  const model::Settings& settings = world.settings();
  Report report;
  report.row("scene", scene.description.path);
  report.row("bodies", fmt::format("{} dynamic, {} fixed, {} kinematic, of {} shapes",
                                   count_kind(world.bodies(), model::BodyKind::dynamic),
                                   count_kind(world.bodies(), model::BodyKind::fixed),
                                   count_kind(world.bodies(), model::BodyKind::kinematic),
                                   world.shapes().size()));
  report.row(
      "methods",
      fmt::format("{} level {}, {} ({} contacts), {}", model::to_string(settings.collision.model),
                  settings.collision.level, model::to_string(settings.impulse.method),
                  model::to_string(model::contact_treatment(settings)),
                  model::to_string(settings.time.integrator)));
  report.row("time step", fmt::format("{} ({})", format_duration(findings.first_step),
                                      settings.time.step == 0.0
                                          ? "derived from level, speed and spin at the start"
                                          : "fixed by the scene"));
  report.row("duration",
             fmt::format("{:.4g} s, about {} steps, {} frames", scene.description.duration,
                         format_count(findings.steps), format_count(findings.frames)));
  report.row("preparation", format_duration(findings.preparation_s));
  report.row("expected time",
             findings.trial_s < scene.description.duration
                 ? fmt::format("{} at the pace of the first {}; piles take longer",
                               format_duration(findings.wall_s), format_duration(findings.trial_s))
                 : format_duration(findings.wall_s));
  report.row("memory", format_bytes(findings.memory_bytes));
  for (const std::string& repair : scene.built.repairs) report.row("repaired", repair);
  for (const std::string& warning : scene.built.warnings) report.row("warning", warning);
  if (scene.built.overlaps.empty()) {
    report.row("overlaps", "none at the start");
  } else {
    report.heading(fmt::format("{} pairs overlap at the start, the deepest:",
                               format_count(scene.built.overlaps.size())));
    for (std::size_t i = 0; i < std::min(kListedOverlaps, scene.built.overlaps.size()); ++i) {
      const scene::InitialOverlap& overlap = scene.built.overlaps[i];
      report.row(fmt::format("{} - {}", overlap.body_a, overlap.body_b),
                 fmt::format("{} ({:.2g} voxels)", format_length(overlap.depth),
                             overlap.depth / overlap.voxel_edge));
    }
  }
  return report.text();
}

int run_check(const SceneOptions& options) {
  const ThreadLimit threads(options.threads);
  Stopwatch watch;
  const OpenedScene scene = open_scene(options, false);
  Findings findings;
  findings.preparation_s = watch.lap();
  const double fixed_step = scene.description.settings.time.step;
  findings.first_step = fixed_step > 0.0 ? fixed_step
                                         : dynamics::derived_step(scene.built.world->bodies(),
                                                                  scene.description.settings);
  findings.frames =
      static_cast<std::uint64_t>(scene.description.duration * scene.description.record.fps) + 1;
  const bool refused = !scene.description.allow_initial_overlap &&
                       std::any_of(scene.built.overlaps.begin(), scene.built.overlaps.end(),
                                   [](const auto& overlap) { return overlap.is_refused(); });
  if (!refused) measure_trial(*scene.built.world, scene.description.duration, findings);

  print(options.json ? findings_json(scene, findings).dump() + "\n" : to_text(scene, findings));
  if (!refused) return kSuccess;
  print_error(options.path +
              ": bodies overlap by more than one voxel at the start. Move them apart, or accept it "
              "with world.allow_initial_overlap = true");
  return kInputError;
}

}  // namespace

void add_check_command(CLI::App& app, Action& action) {
  auto options = std::make_shared<SceneOptions>();
  CLI::App* command = app.add_subcommand(
      "check", "Validate a scene; derived time step, memory, expected time, initial overlaps");
  command->footer(kCheckFooter);
  add_scene_options(*command, *options);
  command->callback([options, &action] { action = [options] { return run_check(*options); }; });
}

}  // namespace gotai::cli
