// Figs. 6-26, 6-27: detection does not know how many polygons a body has.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "gotai/core/stopwatch.h"
#include "thesis/catalogue.h"
#include "thesis/drops.h"

namespace gotai::experiments {
namespace {

constexpr int kLevel = 5;

std::vector<Json> sweep(Effort effort) {
  std::vector<Json> points;
  const int finest = effort == Effort::quick ? 6 : 7;
  for (const char* model : {"spheres", "surface"})
    for (int subdivisions = 2; subdivisions <= finest; ++subdivisions) {
      if (subdivisions == 3 || subdivisions == 5) continue;
      points.push_back({{"method", "C"},
                        {"model", model},
                        {"level", kLevel},
                        {"triangles", 20 << (2 * subdivisions)},
                        {"subdivisions", subdivisions}});
    }
  return points;
}

std::shared_ptr<const voxel::Shape> rock(int subdivisions, const std::string& model) {
  geometry::GeneratorOptions options;
  options.shape = "rock";
  options.subdivisions = subdivisions;
  return prepare(options, kFinestPrepared, model);
}

/// All states of one run, which every mesh then replays: chaos would change the contacts between
/// runs.
std::vector<Snapshot> recorded_run(const Setup& setup) {
  World world = world_with_floor(setup);
  Drop drop;
  drop.shape = rock(2, setup.model);
  drop.count = 5;
  add_drop(world, drop);
  std::vector<Snapshot> states;
  while (world.time() < 2.0) {
    states.push_back(world.snapshot());
    world.step();
  }
  return states;
}

Json run(const Json& point, const std::string& /*folder*/) {
  Setup defaults;
  defaults.dt = 1.0 / 200.0;
  defaults.restitution = 0.3;
  defaults.friction = 0.3;
  const Setup setup = setup_of(point, defaults);
  static std::map<std::string, std::vector<Snapshot>> known;
  std::vector<Snapshot>& states = known[setup.model];
  if (states.empty()) states = recorded_run(setup);

  World world = world_with_floor(setup);
  Drop drop;
  Stopwatch clock;
  drop.shape = rock(point["subdivisions"], setup.model);
  Json record;
  record["prepare_s"] = clock.seconds();
  drop.count = 5;
  add_drop(world, drop);
  std::vector<double> times;
  std::uint64_t contacts = 0;
  for (int repeat = 0; repeat < 5; ++repeat) {
    collision::CollisionCache cache;
    model::ContactSet found;
    contacts = 0;
    double seconds = 0.0;
    for (const Snapshot& state : states) {
      world.restore(state);
      clock.lap();
      collision::find_contacts(world.bodies(), world.shapes(), world.settings().collision, 0.0,
                               cache, found);
      seconds += clock.lap();
      contacts += found.size();
    }
    times.push_back(1e3 * seconds);
  }
  record["detection_ms"] = *std::min_element(times.begin(), times.end());
  record["contacts_mean"] = static_cast<double>(contacts) / static_cast<double>(states.size());
  return record;
}

Outcome conclude(const std::vector<Record>& records, Effort /*effort*/) {
  Outcome outcome;
  Plot plot{"Fig. 6-26",
            "Detection time by number of polygons",
            "triangles per body",
            "time for 2 s [ms]",
            true,
            false,
            {}};
  for (const char* model : {"spheres", "surface"}) {
    Series series;
    series.label = model;
    for (const Record& r : select(records, {{"model", model}})) {
      series.x.push_back(r["triangles"]);
      series.y.push_back(r["detection_ms"]);
    }
    const auto [low, high] = std::minmax_element(series.y.begin(), series.y.end());
    outcome.verdicts.push_back(at_most(
        fmt::format("detection time max / min over polygon counts, {}", model), *high / *low, 1.2));
    plot.series.push_back(series);
  }
  outcome.plots.push_back(plot);
  Table table{"",
              "Detection on one recorded trajectory",
              {{"model", "triangles", "preparation [s]", "detection [ms]", "mean contacts"}}};
  for (const Record& r : records)
    table.rows.push_back({r["model"], std::to_string(r["triangles"].get<int>()),
                          fmt::format("{:.2f}", r["prepare_s"].get<double>()),
                          fmt::format("{:.2f}", r["detection_ms"].get<double>()),
                          fmt::format("{:.2f}", r["contacts_mean"].get<double>())});
  outcome.tables.push_back(table);
  return outcome;
}

}  // namespace

Experiment polygons() {
  return {"polygons",
          "Figs. 6-26, 6-27",
          "Detection time by number of polygons",
          "Five rocks of 320 to 327,680 triangles fall at level 5 (dt = 1/200, 2 s). Detection is "
          "timed on "
          "one recorded trajectory that every mesh replays. Its cost depends on the level and not "
          "on the "
          "polygons.",
          true,
          sweep,
          run,
          conclude};
}

}  // namespace gotai::experiments
