#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "browser.h"
#include "commands.h"
#include "console.h"
#include "exit_code.h"
#include "gotai/core/error.h"
#include "gotai/core/parallel.h"
#include "gotai/core/stopwatch.h"
#include "gotai/recording/recorder.h"
#include "gotai/recording/recording_reader.h"
#include "gotai/view/live_server.h"
#include "gotai/world/run_summary.h"
#include "interrupt.h"
#include "output_file.h"
#include "scene_options.h"
#include "summary_text.h"

namespace gotai::cli {
namespace {

constexpr const char* kRunFooter = R"(Examples:
  gotai run scene.toml -o run.h5
  gotai run scene.toml -o run.h5 --set impulse.method=penalty --set world.duration=2
  gotai run scene.toml --json --threads 1          only the figures, nothing is recorded
  gotai run scene.toml --live --open               watch it in the browser while it runs
  gotai run --resume run.h5                        go on with an interrupted run, bit for bit
  gotai run --resume run.h5 --set world.duration=9 the same, and longer
Ctrl-C finishes the step and closes the recording; what was flushed survives even kill -9.
Go on with `gotai view run.h5 --open`, `gotai info run.h5` or `gotai export run.h5 -o run.glb`.)";

constexpr double kPatience = 15.0;  // for a browser to start [s]

struct RunOptions {
  SceneOptions scene;
  std::string output;
  std::string resumed;  ///< recording to go on with; "" for a new run
  bool force = false;
  bool live = false;
  bool open = false;
  int port = 0;
};

std::string progress_text(const World& world, double duration, const model::StepReport& report,
                          double wall_s) {
  const double done = std::clamp(world.time() / duration, 0.0, 1.0);
  constexpr int kWidth = 24;
  const int filled = static_cast<int>(done * kWidth);
  return fmt::format(
      "[{:=<{}}{: <{}}] {:3.0f} %  t = {:.3f} s  {} contacts  {:.3g} ms/step  {} left", "", filled,
      "", kWidth - filled, 100.0 * done, world.time(), report.contacts, 1e3 * report.total_s(),
      done > 0.0 ? format_duration(wall_s * (1.0 - done) / done) : "?");
}

recording::RecorderOptions recorder_options(const scene::RecordSettings& record) {
  recording::RecorderOptions options;
  options.fps = record.fps;
  options.contacts = record.contacts;
  options.checkpoint = record.checkpoint;
  return options;
}

recording::Recorder start_recording(const RunOptions& options, const scene::SceneDescription& scene,
                                    const World& world) {
  if (options.force) std::filesystem::remove(options.output);
  return {options.output,
          world,
          {scene.path, scene.text, scene.overrides},
          recorder_options(scene.record)};
}

// The scene of a recording. Only what leaves its past as it is may be overridden.
OpenedScene reopen_scene(const RunOptions& options) {
  for (const std::string& assignment : options.scene.overrides) {
    if (assignment.starts_with("world.duration=") || assignment.starts_with("record.checkpoint=")) {
      continue;
    }
    throw InvalidArgument("--set", assignment,
                          "a resumed run keeps its scene; only world.duration and "
                          "record.checkpoint may change");
  }
  const recording::RecordingReader recording(options.resumed);
  std::vector<std::string> overrides = recording.overrides();
  overrides.insert(overrides.end(), options.scene.overrides.begin(), options.scene.overrides.end());
  return build_scene(scene::parse_scene(recording.scene_text(), recording.scene_path(), overrides),
                     true);
}

std::unique_ptr<view::LiveServer> start_live_view(const RunOptions& options,
                                                  const scene::SceneDescription& scene,
                                                  const World& world, const InterruptGuard& guard) {
  if (!options.live) return nullptr;
  auto live = std::make_unique<view::LiveServer>(
      world, std::filesystem::path(scene.path).stem().string(), "gotai " GOTAI_VERSION,
      view::LiveServer::Options{.port = options.port, .fps = scene.record.fps});
  print_error(fmt::format("live at {} until the run ends", live->address()));
  if (options.open) {
    open_in_browser(live->address());
    // Short runs would be over before the page is there.
    if (!live->wait_for_viewer(kPatience, [&guard] { return guard.is_interrupted(); }) &&
        !guard.is_interrupted())
      print_error("no browser has asked for the page yet; the run goes on");
  }
  return live;
}

// Steps to the end or the interruption.
void simulate(World& world, double duration, RunMonitor& monitor,
              std::optional<recording::Recorder>& recorder, view::LiveServer* live,
              const InterruptGuard& guard, const Stopwatch& watch) {
  ProgressLine progress;
  while (!world.has_reached(duration) && !guard.is_interrupted()) {
    if (live != nullptr) {
      live->wait_while_paused([&guard] { return guard.is_interrupted(); });
      if (guard.is_interrupted()) break;
    }
    const model::StepReport report = world.step();
    monitor.on_step(world, report);
    if (recorder) recorder->on_step(world, report);
    if (live != nullptr) live->on_step(world, report);
    if (progress.is_due()) {
      progress.show(progress_text(world, duration, report, watch.seconds()));
    }
  }
}

std::optional<recording::Recorder> open_recorder(const RunOptions& options,
                                                 const scene::SceneDescription& scene,
                                                 World& world) {
  if (!options.resumed.empty()) {
    return recording::Recorder::resume(options.resumed, world, recorder_options(scene.record));
  }
  if (!options.output.empty()) return start_recording(options, scene, world);
  return std::nullopt;
}

int run_scene(const RunOptions& options) {
  const ThreadLimit threads(options.scene.threads);
  if (!options.output.empty()) require_free(options.output, options.force);
  OpenedScene scene =
      options.resumed.empty() ? open_scene(options.scene, true) : reopen_scene(options);
  World& world = *scene.built.world;
  for (const std::string& warning : scene.built.warnings) print_error("warning: " + warning);

  const InterruptGuard guard;
  std::optional<recording::Recorder> recorder = open_recorder(options, scene.description, world);
  const std::unique_ptr<view::LiveServer> live =
      start_live_view(options, scene.description, world, guard);
  const Stopwatch watch;
  RunMonitor monitor(world);
  try {
    simulate(world, scene.description.duration, monitor, recorder, live.get(), guard, watch);
  } catch (const SimulationError& error) {
    if (!recorder) throw;
    throw SimulationError(std::string(error.what()) + "; the state before it is kept in " +
                          recorder->path());
  }
  const RunSummary summary = monitor.summary(world, watch.seconds());
  if (recorder) recorder->finish(world, to_json(summary).dump());
  // Open pages fetch the last frames; nobody is waited for after an interruption.
  if (live) live->finish(guard.is_interrupted() ? 0.0 : 5.0);

  if (options.scene.json) {
    print(to_json(summary).dump() + "\n");
  } else {
    print(to_table(summary));
    if (recorder) print(fmt::format("recorded in {}\n", recorder->path()));
  }
  if (!guard.is_interrupted()) return kSuccess;
  print_error(fmt::format("interrupted at t = {:.4g} s of {:.4g} s{}", world.time(),
                          scene.description.duration,
                          recorder ? "; go on with: gotai run --resume " + recorder->path() : ""));
  return kInterrupted;
}

}  // namespace

void add_run_command(CLI::App& app, Action& action) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command = app.add_subcommand("run", "Simulate a scene and record it");
  command->footer(kRunFooter);
  add_scene_options(*command, options->scene);
  command
      ->add_option("-o,--output", options->output,
                   "Recording to write (HDF5); without it nothing is recorded")
      ->type_name("OUT.h5");
  command->add_flag("--force", options->force, "Overwrite an existing output");
  CLI::Option* live = command->add_flag(
      "--live", options->live, "Show the simulation in a browser of this machine while it runs");
  command->add_option("--port", options->port, "Port of the live view; 0 takes any free one")
      ->needs(live)
      ->check(CLI::Range(0, 65535))
      ->type_name("PORT");
  command
      ->add_flag("--open", options->open,
                 "Open the live view in the browser, and begin when the page is there")
      ->needs(live);
  CLI::Option* scene = command->get_option("SCENE")->required(false);
  command
      ->add_option("--resume", options->resumed,
                   "Go on with this recording from its last checkpoint, instead of SCENE")
      ->type_name("RUN.h5")
      ->excludes(scene)
      ->excludes("--output")
      ->excludes("--force");
  command->callback([options, &action] {
    if (options->scene.path.empty() && options->resumed.empty()) {
      throw CLI::RequiredError("SCENE or --resume RUN.h5");
    }
    action = [options] { return run_scene(*options); };
  });
}

}  // namespace gotai::cli
