// Figs. 6-11..6-25, Tables 6-6..6-10: mean errors of the centres of mass of falling hexapods and
// rocks.
#include <fmt/format.h>

#include <map>
#include <mutex>
#include <tuple>

#include "gotai/core/stopwatch.h"
#include "thesis/catalogue.h"
#include "thesis/drops.h"

namespace gotai::experiments {
namespace {

/// What differs between the two experiments.
struct Kind {
  const char* shape;
  double extent;
  double dt;
  bool level_steps;  // configurations with level-dependent steps, too
};
constexpr Kind kHexapods{"hexapod", 2.0, 1.0 / 100.0, false};
constexpr Kind kRocks{"rock", 1.0, 1.0 / 200.0, true};

constexpr double kWindow = 1.0;  // [s]: later, chaos makes errors meaningless (erratum 47)

Drop drop_of(const Kind& kind, std::uint64_t seed, const std::string& model) {
  Drop drop;
  geometry::GeneratorOptions options;
  options.shape = kind.shape;
  options.seed = 1;
  drop.shape = prepare(options, kFinestPrepared, model);
  drop.extent = kind.extent;
  drop.seed = seed;
  return drop;
}

Setup base_setup() {
  Setup setup;
  setup.restitution = 0.3;
  setup.friction = 0.3;
  setup.exact = false;
  return setup;
}

/// The reference of a seed: "spheres" shares the bias of level 5, "surface" has none.
/// Computed once per program, because every configuration is compared with it.
const Trajectory& reference(const Kind& kind, std::uint64_t seed, const std::string& model) {
  static std::mutex mutex;
  static std::map<std::tuple<std::string, std::uint64_t, std::string>, Trajectory> known;
  const std::lock_guard lock(mutex);
  Trajectory& trajectory = known[{kind.shape, seed, model}];
  if (trajectory.empty()) {
    Setup setup = base_setup();
    setup.model = model;
    setup.level = model == "spheres" ? 5 : 6;
    setup.dt = 1.0 / 1000.0;
    trajectory = run_drop(setup, drop_of(kind, seed, model), kWindow);
  }
  return trajectory;
}

std::vector<Json> sweep(const Kind& kind, Effort effort) {
  std::vector<Json> points;
  const int seeds = 8;
  // The surface reference is the dearest run; the quick effort affords it for some seeds.
  const int surface_seeds = effort == Effort::full ? seeds : 2;
  for (int seed = 1; seed <= seeds; ++seed) {
    for (const auto& [method, level] :
         {std::pair("C", 5), {"C", 4}, {"A", 5}, {"A", 4}, {"I", 5}, {"I", 4}})
      points.push_back({{"method", method},
                        {"model", "spheres"},
                        {"level", level},
                        {"seed", seed},
                        {"steps", "fixed"}});
    points.push_back({{"method", "noise"},
                      {"model", "spheres"},
                      {"level", 5},
                      {"seed", seed},
                      {"steps", "fixed"}});
    if (seed <= surface_seeds)
      for (const int level : {3, 4, 5})
        points.push_back({{"method", "C"},
                          {"model", "surface"},
                          {"level", level},
                          {"seed", seed},
                          {"steps", "fixed"}});
    if (kind.level_steps)
      for (const char* method : {"C", "A"})
        points.push_back({{"method", method},
                          {"model", "spheres"},
                          {"level", 4},
                          {"seed", seed},
                          {"steps", "by level"}});
  }
  for (Json& point : points) point["surface_reference"] = point["seed"].get<int>() <= surface_seeds;
  return points;
}

Json run(const Kind& kind, const Json& point) {
  const std::uint64_t seed = point["seed"];
  const bool noise = point["method"] == "noise";
  Setup setup = base_setup();
  setup.dt = kind.dt;
  Json configured = point;
  if (noise) configured["method"] = "C";
  setup = setup_of(configured, setup);
  if (point["steps"] == "by level") setup.dt = step_of_level(setup.level);
  // The step of the reference: what is left is the level's own error.
  if (setup.model == "surface") setup.dt = 1.0 / 1000.0;
  Drop drop = drop_of(kind, seed, setup.model);
  if (noise) {
    drop.perturbation = 1e-6;
    setup.dt = 1.0 / 1000.0;
  }
  Stopwatch clock;
  const Trajectory trajectory = run_drop(setup, drop, kWindow);
  Json record;
  record["time_ms"] = 1e3 * clock.seconds();
  record["error"] = mean_error(trajectory, reference(kind, seed, "spheres"), kind.extent);
  if (point["surface_reference"].get<bool>())
    record["error_surface"] = mean_error(trajectory, reference(kind, seed, "surface"), kind.extent);
  std::vector<double> t;
  std::vector<double> curve;
  const Trajectory& exact = reference(kind, seed, "spheres");
  for (std::size_t k = 0; k < trajectory.size(); ++k) {
    t.push_back(static_cast<double>(k + 1) / 50.0);
    curve.push_back(mean_error({trajectory[k]}, {exact[k]}, kind.extent));
  }
  record["curves"] = {{"t", t}, {"error", curve}};
  return record;
}

double median_of(const std::vector<Record>& records, const char* metric) {
  std::vector<double> values;
  for (const Record& r : records)
    if (r.contains(metric)) values.push_back(r[metric]);
  return median(values);
}

Outcome conclude(const Kind& kind, const std::string& first_figure,
                 const std::vector<Record>& records) {
  Outcome outcome;
  const auto of = [&](const char* method, int level, const char* metric = "error",
                      const char* model = "spheres", const char* steps = "fixed") {
    return median_of(
        select(records, {{"method", method}, {"model", model}, {"level", level}, {"steps", steps}}),
        metric);
  };
  const double c5 = of("C", 5);
  const double a5 = of("A", 5);
  const double i5 = of("I", 5);
  outcome.verdicts.push_back(holds("C5 < A5 < I5 (medians over the seeds)", c5 < a5 && a5 < i5,
                                   fmt::format("{:.4f}, {:.4f}, {:.4f} L", c5, a5, i5)));
  const double s3 = of("C", 3, "error_surface", "surface");
  const double s5 = of("C", 5, "error_surface", "surface");
  outcome.verdicts.push_back(
      holds("surface model: error against the level-independent reference falls with the level",
            s5 < s3, fmt::format("{:.4f} at level 3, {:.4f} at level 5", s3, s5)));
  outcome.verdicts.push_back(
      at_most("noise floor (reference against itself, start moved by 1e-6)", of("noise", 5), c5));

  Table table{kind.level_steps ? "Tables 6-6, 6-7" : "Tables 6-6, 6-8",
              "Mean error of the centres of mass [L], median over the seeds",
              {{"configuration", "against level 5", "against the surface", "time [ms]"}}};
  Plot plot{first_figure,
            fmt::format("Falling {}s: error by time", kind.shape),
            "time [s]",
            "mean error [L]",
            false,
            true,
            {}};
  const auto add = [&](const std::string& name, const Json& match) {
    const std::vector<Record> found = select(records, match);
    if (found.empty()) return;
    table.rows.push_back({name, fmt::format("{:.4f}", median_of(found, "error")),
                          fmt::format("{:.4f}", median_of(found, "error_surface")),
                          fmt::format("{:.1f}", median_of(found, "time_ms"))});
    Series series;
    series.label = name;
    series.markers = false;
    series.x = found.front()["curves"]["t"].get<std::vector<double>>();
    for (std::size_t k = 0; k < series.x.size(); ++k) {
      std::vector<double> values;
      for (const Record& r : found) values.push_back(r["curves"]["error"][k]);
      series.y.push_back(median(values));
    }
    plot.series.push_back(series);
  };
  for (const auto& [method, level, number] : {std::tuple("C", 5, ""),
                                              {"C", 4, "i: "},
                                              {"A", 5, "ii: "},
                                              {"A", 4, "iii: "},
                                              {"I", 5, "iv: "},
                                              {"I", 4, "v: "}})
    add(fmt::format("{}{}{}", number, method, level),
        {{"method", method}, {"model", "spheres"}, {"level", level}, {"steps", "fixed"}});
  add("vi: C4, step by level",
      {{"method", "C"}, {"model", "spheres"}, {"level", 4}, {"steps", "by level"}});
  add("vii: A4, step by level",
      {{"method", "A"}, {"model", "spheres"}, {"level", 4}, {"steps", "by level"}});
  add("surface, level 3", {{"method", "C"}, {"model", "surface"}, {"level", 3}});
  add("surface, level 4", {{"method", "C"}, {"model", "surface"}, {"level", 4}});
  add("surface, level 5", {{"method", "C"}, {"model", "surface"}, {"level", 5}});
  add("noise floor", {{"method", "noise"}});
  outcome.tables.push_back(table);
  outcome.plots.push_back(plot);
  return outcome;
}

Experiment make(const Kind& kind, const char* id, const char* thesis, const char* title,
                const char* figure) {
  return {
      id,
      thesis,
      title,
      "Four bodies fall on the floor and on each other (e = 0.3, mu = 0.3). Mean distance of the "
      "centres of mass from a reference, in extents, over the first second, median over 8 seeds. "
      "The sphere reference (level 5, dt = 1/1000) shares the bias of its level; the surface "
      "reference "
      "(level 6, dt = 1/1000) does not. The noise floor is the reference against itself, started "
      "1e-6 m away: trajectories of colliding bodies diverge from any reference.",
      false,
      [&kind](Effort effort) { return sweep(kind, effort); },
      [&kind](const Json& point, const std::string&) { return run(kind, point); },
      [&kind, figure](const std::vector<Record>& records, Effort) {
        return conclude(kind, figure, records);
      }};
}

}  // namespace

Experiment pile_error() {
  return make(kHexapods, "pile-error", "Figs. 6-11..6-16, Tables 6-6, 6-8",
              "Falling hexapods: error of every configuration", "Figs. 6-11..6-16");
}

Experiment rocks_error() {
  return make(kRocks, "rocks-error", "Figs. 6-17..6-25, Tables 6-6, 6-7, 6-9, 6-10",
              "Falling rocks: error of every configuration", "Figs. 6-17..6-25");
}

}  // namespace gotai::experiments
