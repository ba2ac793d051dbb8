// Figs. 6-9, 6-10, Table 6-5: ten hexapods fall on each other; what each method costs.
#include <fmt/format.h>

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

Json run(const Json& point, const std::string& /*folder*/) {
  if (point["measure"] == "error") return run_level_error(point, error_scene());
  const Setup setup = setup_of(point, base_setup(point["friction"]));
  const Drop drop = ten_hexapods(setup, 1);
  Json record;
  time_runs(
      [&] {
        World world = world_with_floor(setup);
        add_drop(world, drop);
        return world;
      },
      kDuration, point["repeats"], record);
  return record;
}

Outcome conclude(const std::vector<Record>& records, Effort /*effort*/) {
  Outcome outcome;
  const std::vector<Record> shown = select(records, {{"measure", "time"}, {"friction", 0.3}});
  for (const Record& c : select(shown, {{"method", "C"}, {"model", "spheres"}})) {
    const Record& a = pick(shown, {{"method", "A"}, {"model", "spheres"}, {"level", c["level"]}});
    const double ratio = a["impulse_least_ms"].get<double>() / c["impulse_least_ms"].get<double>();
    outcome.verdicts.push_back(
        at_most(fmt::format("impulse time of A / C at level {} (far below)", c["level"].get<int>()),
                ratio, c["level"].get<int>() <= 3 ? 0.7 : 0.3));
  }
  judge_level_error(outcome, select(records, {{"measure", "error"}}), "ten hexapods");
  show_times(outcome, shown, "Ten hexapods, mu = 0.3", kDuration, "Table 6-5", "Table 6-5");
  outcome.tables.push_back(
      level_table(shown, "detection_ms", "Table 6-5", "Ten hexapods, mu = 0.3: detection [ms]"));
  outcome.tables.push_back(level_table(shown, "contacts_mean", "", "Mean contacts"));
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
