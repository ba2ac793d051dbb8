// Figs. 6-9, 6-10, Table 6-5: ten hexapods fall on each other; what each method costs.
#include <fmt/format.h>

#include <algorithm>

#include "gotai/core/parallel.h"
#include "thesis/catalogue.h"
#include "thesis/drops.h"
#include "thesis/level_error.h"

namespace gotai::experiments {
namespace {

constexpr double kExtent = 2.0;    // L of the hexapod [m]
constexpr double kDuration = 3.0;  // of a timed run [s]
constexpr int kSeeds = 8;          // of the error

Setup base_setup(double friction) {
  Setup setup;
  setup.restitution = 0.3;
  setup.friction = friction;
  setup.dt = 0.01;
  setup.reduced = setup.substepped = true;
  return setup;
}

Drop ten_hexapods(const Setup& setup, std::uint64_t seed) {
  geometry::GeneratorOptions hexapod;
  hexapod.shape = "hexapod";
  Drop drop;
  drop.shape = prepare(hexapod, kFinestPrepared, setup);
  drop.extent = kExtent;
  drop.count = 10;
  drop.seed = seed;
  return drop;
}

std::vector<Json> sweep(Effort effort) {
  std::vector<Json> points;
  const int finest = effort == Effort::quick ? 4 : 6;
  for (const char* model : {"spheres", "surface"})
    for (const double friction : {0.0, 0.3}) {
      if (effort == Effort::quick && friction == 0.0) continue;
      for (const char* method : {"C", "A", "I"})
        for (int level = 3; level <= finest; ++level)
          points.push_back({{"method", method},
                            {"model", model},
                            {"level", level},
                            {"friction", friction},
                            {"measure", "time"},
                            {"repeats", effort == Effort::quick ? 3 : 5}});
    }
  for (const char* method : {"C", "A"})
    for (int level = 3; level <= finest; ++level)
      points.push_back({{"method", method},
                        {"model", "spheres"},
                        {"level", level},
                        {"friction", 0.3},
                        {"measure", "same states"},
                        {"repeats", effort == Effort::quick ? 3 : 5}});
  add_level_error_points(points, kSeeds);
  return points;
}

LevelErrorScene error_scene() {
  const auto make = [](const Setup& setup, std::uint64_t seed) {
    World world = world_with_floor(setup);
    add_drop(world, ten_hexapods(setup, seed));
    return world;
  };
  return {"pile-time", make, base_setup(0.3), kExtent, 1.0};
}

World pile(const Setup& setup) {
  World world = world_with_floor(setup);
  add_drop(world, ten_hexapods(setup, 1));
  return world;
}

/// Time for the impulses of a method at every state of C's run. In its own run A lets bodies sink
/// into each other, up to fifty times C's contacts: that is another problem, not another method.
Json time_same_states(const Json& point) {
  const ThreadLimit one_thread(1);
  const Setup setup = setup_of(point, base_setup(point["friction"]));
  Setup constraint = setup;
  constraint.method = "C";
  World recorded = pile(constraint);
  std::vector<Snapshot> states;
  while (recorded.time() < kDuration) {
    states.push_back(recorded.snapshot());
    recorded.step();
  }
  World world = pile(setup);
  std::vector<double> times;
  std::uint64_t contacts = 0;
  const int repeats = point["repeats"];
  for (int k = 0; k < repeats; ++k) {
    double seconds = 0.0;
    contacts = 0;
    for (const Snapshot& state : states) {
      world.restore(state);
      const model::StepReport report = world.step();
      seconds += report.impulse_s;
      contacts += report.contacts;
    }
    times.push_back(1e3 * seconds);
  }
  return {{"impulse_ms", median(times)},
          {"impulse_least_ms", *std::min_element(times.begin(), times.end())},
          {"contacts_mean", static_cast<double>(contacts) / static_cast<double>(states.size())}};
}

Json run(const Json& point, const std::string& /*folder*/) {
  if (point["measure"] == "error") return run_level_error(point, error_scene());
  if (point["measure"] == "same states") return time_same_states(point);
  const Setup setup = setup_of(point, base_setup(point["friction"]));
  Json record;
  time_runs([&] { return pile(setup); }, kDuration, point["repeats"], record);
  return record;
}

Outcome conclude(const std::vector<Record>& records, Effort /*effort*/) {
  Outcome outcome;
  const std::vector<Record> shown = select(records, {{"measure", "time"}, {"friction", 0.3}});
  const std::vector<Record> same = select(records, {{"measure", "same states"}});
  for (const Record& c : select(same, {{"method", "C"}})) {
    const Record& a = pick(same, {{"method", "A"}, {"level", c["level"]}});
    const double ratio = a["impulse_least_ms"].get<double>() / c["impulse_least_ms"].get<double>();
    outcome.verdicts.push_back(
        at_most(fmt::format("impulse time of A / C on the same states, level {} (far below)",
                            c["level"].get<int>()),
                ratio, 0.3));
  }
  judge_level_error(outcome, select(records, {{"measure", "error"}}), "ten hexapods");
  show_times(outcome, shown, "Ten hexapods, mu = 0.3", kDuration, "Table 6-5", "Table 6-5");
  outcome.tables.push_back(
      level_table(shown, "detection_ms", "Table 6-5", "Ten hexapods, mu = 0.3: detection [ms]"));
  outcome.tables.push_back(level_table(shown, "contacts_mean", "", "Mean contacts"));
  outcome.tables.push_back(level_table(same, "impulse_ms", "",
                                       "Impulses alone on the states of C's run, mu = 0.3 [ms]"));
  return outcome;
}

}  // namespace

Experiment pile_time() {
  return {"pile-time",
          "Figs. 6-9, 6-10, Table 6-5",
          "Ten hexapods fall: computing time by level and method",
          "Ten hexapods fall on the floor and on each other (e = 0.3, dt = 1/100, 3 s). The "
          "apparent contact "
          "point makes the complementarity problem small, so its impulse time stays far below that "
          "of the "
          "full one; detection is the same for both.",
          true,
          sweep,
          run,
          conclude};
}

}  // namespace gotai::experiments
