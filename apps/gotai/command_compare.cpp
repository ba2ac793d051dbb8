#include <fmt/format.h>

#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "commands.h"
#include "console.h"
#include "exit_code.h"
#include "gotai/core/error.h"
#include "gotai/core/parallel.h"
#include "gotai/core/stopwatch.h"
#include "gotai/world/run_summary.h"
#include "interrupt.h"
#include "output_file.h"
#include "scene_options.h"

namespace gotai::cli {
namespace {

constexpr const char* kCompareFooter = R"(Examples:
  gotai compare examples/spin.toml
  gotai compare scene.toml -o methods.csv --set world.duration=1 --set collision.level=4
The scene runs once with every impulse method, everything else as it says. `distance` is the mean
distance of the bodies' centres of mass from those of constraint/all/exact at the end: the exact
solution of the scene's contact problems. docs/methods.md says what each method promises.)";

// One way to turn contacts into impulses.
struct Variant {
  model::ImpulseMethodName method;
  model::ContactTreatment contacts;
  model::SolverName solver;
};

// What came of one run.
struct Outcome {
  Variant variant;
  RunSummary summary;
  std::string failure;             ///< "" when it reached the end
  std::vector<Vec3> centres;       ///< of mass at the end, dynamic bodies [m]
  std::optional<double> distance;  ///< from the reference [m]
};

struct CompareOptions {
  SceneOptions scene;
  std::string output;
  bool force = false;
};

// The reference comes first.
std::vector<Variant> variants_of(const model::Settings& settings) {
  using model::ContactTreatment;
  using model::ImpulseMethodName;
  using model::SolverName;
  std::vector<Variant> variants = {
      {ImpulseMethodName::constraint, ContactTreatment::all, SolverName::exact},
      {ImpulseMethodName::constraint, ContactTreatment::all, SolverName::iterative},
      {ImpulseMethodName::constraint, ContactTreatment::apparent, SolverName::automatic}};
  if (settings.collision.model == model::CollisionModel::surface) {
    variants.push_back(
        {ImpulseMethodName::constraint, ContactTreatment::reduced, SolverName::automatic});
  }
  for (const auto method :
       {ImpulseMethodName::impulse, ImpulseMethodName::impulse_averaged, ImpulseMethodName::penalty,
        ImpulseMethodName::sem, ImpulseMethodName::vector_field}) {
    variants.push_back({method, ContactTreatment::all, SolverName::automatic});
  }
  return variants;
}

std::string name_of(const Variant& variant) {
  if (variant.method != model::ImpulseMethodName::constraint) {
    return std::string(model::to_string(variant.method));
  }
  std::string name =
      fmt::format("{}/{}", model::to_string(variant.method), model::to_string(variant.contacts));
  if (variant.contacts == model::ContactTreatment::all) {
    name += fmt::format("/{}", model::to_string(variant.solver));
  }
  return name;
}

Outcome run_variant(const CompareOptions& options, const Variant& variant,
                    const InterruptGuard& guard) {
  scene::SceneDescription description =
      scene::load_scene(options.scene.path, options.scene.overrides);
  description.settings.impulse.method = variant.method;
  description.settings.impulse.contacts = variant.contacts;
  description.settings.impulse.solver = variant.solver;
  OpenedScene scene = build_scene(std::move(description), true);
  World& world = *scene.built.world;

  Outcome outcome{variant, {}, "", {}, std::nullopt};
  RunMonitor monitor(world);
  const Stopwatch watch;
  ProgressLine progress;
  try {
    while (!world.has_reached(scene.description.duration) && !guard.is_interrupted()) {
      monitor.on_step(world, world.step());
      if (progress.is_due()) {
        progress.show(fmt::format("{}: t = {:.3f} s of {:.3f} s", name_of(variant), world.time(),
                                  scene.description.duration));
      }
    }
  } catch (const SimulationError& error) {
    outcome.failure = error.what();
  }
  outcome.summary = monitor.summary(world, watch.seconds());
  for (model::BodyIndex i = 0; i < world.bodies().size(); ++i) {
    if (world.bodies().is_dynamic(i)) outcome.centres.push_back(world.bodies().x_W[i]);
  }
  return outcome;
}

void measure_distance(const Outcome& reference, Outcome& outcome) {
  if (!reference.failure.empty() || !outcome.failure.empty() || outcome.centres.empty()) return;
  double sum = 0.0;
  for (std::size_t i = 0; i < outcome.centres.size(); ++i) {
    sum += (outcome.centres[i] - reference.centres[i]).norm();
  }
  outcome.distance = sum / static_cast<double>(outcome.centres.size());
}

nlohmann::ordered_json outcome_json(const Outcome& outcome) {
  const RunSummary& s = outcome.summary;
  return {{"method", model::to_string(outcome.variant.method)},
          {"contact_treatment", model::to_string(outcome.variant.contacts)},
          {"solver", model::to_string(outcome.variant.solver)},
          {"steps", s.steps},
          {"simulated_s", s.simulated_s},
          {"collision_ms", s.phase_ms.collision},
          {"impulse_ms", s.phase_ms.impulse},
          {"integration_ms", s.phase_ms.integration},
          {"contacts_mean", s.contacts.mean},
          {"contacts_max", s.contacts.max},
          {"overlap_max", s.overlap.max},
          {"energy_initial", s.energy.initial},
          {"energy_final", s.energy.final},
          {"energy_max_gain", s.energy.max_gain},
          {"residual_max", s.residual_max},
          {"plastic_islands", s.plastic_islands},
          {"substeps_max", s.substeps_max},
          {"distance", outcome.distance ? nlohmann::ordered_json(*outcome.distance)
                                        : nlohmann::ordered_json(nullptr)},
          {"failure", outcome.failure}};
}

// The same fields as in JSON, one row per method.
std::string to_csv(const std::vector<Outcome>& outcomes) {
  std::string text;
  for (const Outcome& outcome : outcomes) {
    const nlohmann::ordered_json json = outcome_json(outcome);
    std::string header;
    std::string row;
    for (const auto& [key, value] : json.items()) {
      const std::string separator = header.empty() ? "" : ",";
      header += separator + key;
      row += separator + (value.is_null() ? "" : value.dump());
    }
    if (text.empty()) text = header + "\n";
    text += row + "\n";
  }
  return text;
}

std::string outcomes_table(const std::vector<Outcome>& outcomes) {
  std::string text = fmt::format(
      "{:24} {:>27} {:>15} {:>10} {:>23} {:>10}\n{:24} {:>9} {:>8} {:>8} "
      "{:>8} {:>6} {:>10} {:>11} {:>11} {:>10}\n",
      "", "ms per step", "contacts", "overlap", "energy [J]", "distance", "method", "collision",
      "impulse", "motion", "mean", "max", "max [mm]", "final", "max gain", "[mm]");
  for (const Outcome& outcome : outcomes) {
    const RunSummary& s = outcome.summary;
    text += fmt::format(
        "{:24} {:9.3g} {:8.3g} {:8.3g} {:8.4g} {:6} {:10.3g} {:11.4g} {:11.2g} {:>10}\n",
        name_of(outcome.variant), s.phase_ms.collision, s.phase_ms.impulse, s.phase_ms.integration,
        s.contacts.mean, s.contacts.max, 1e3 * s.overlap.max, s.energy.final, s.energy.max_gain,
        outcome.distance ? fmt::format("{:.3g}", 1e3 * *outcome.distance) : "-");
    if (!outcome.failure.empty()) text += fmt::format("  stopped: {}\n", outcome.failure);
  }
  return text;
}

int compare(const CompareOptions& options) {
  const ThreadLimit threads(options.scene.threads);
  if (!options.output.empty()) require_free(options.output, options.force);
  const model::Settings settings =
      scene::load_scene(options.scene.path, options.scene.overrides).settings;
  const InterruptGuard guard;
  std::vector<Outcome> outcomes;
  for (const Variant& variant : variants_of(settings)) {
    outcomes.push_back(run_variant(options, variant, guard));
    if (guard.is_interrupted()) {
      print_error(
          fmt::format("interrupted while running {}; nothing was written", name_of(variant)));
      return kInterrupted;
    }
    measure_distance(outcomes.front(), outcomes.back());
  }
  if (!options.output.empty()) {
    std::ofstream out(options.output, std::ios::binary);
    out << to_csv(outcomes);
    if (!out.flush()) throw FileError(options.output, "cannot be written");
  }
  if (options.scene.json) {
    nlohmann::ordered_json json = {{"scene", options.scene.path},
                                   {"methods", nlohmann::ordered_json::array()}};
    for (const Outcome& outcome : outcomes) json["methods"].push_back(outcome_json(outcome));
    print(json.dump() + "\n");
  } else {
    print(outcomes_table(outcomes));
  }
  return kSuccess;
}

}  // namespace

void add_compare_command(CLI::App& app, Action& action) {
  auto options = std::make_shared<CompareOptions>();
  CLI::App* command =
      app.add_subcommand("compare", "Run one scene with every impulse method, side by side");
  command->footer(kCompareFooter);
  add_scene_options(*command, options->scene);
  command->add_option("-o,--output", options->output, "Also write the table as CSV")
      ->type_name("FILE.csv");
  command->add_flag("--force", options->force, "Overwrite an existing file");
  command->callback([options, &action] { action = [options] { return compare(*options); }; });
}

}  // namespace gotai::cli
