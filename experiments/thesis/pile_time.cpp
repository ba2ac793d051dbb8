// Figs. 6-9, 6-10, Table 6-5: ten hexapods fall on each other; what each method costs.
#include <fmt/format.h>

#include "thesis/catalogue.h"
#include "thesis/drops.h"

namespace gotai::experiments {
namespace {

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
                            {"repeats", effort == Effort::quick ? 3 : 5}});
    }
  return points;
}

Json run(const Json& point, const std::string& /*folder*/) {
  Setup defaults;
  defaults.restitution = 0.3;
  defaults.friction = point["friction"];
  defaults.dt = 0.01;
  defaults.exact = false;
  const Setup setup = setup_of(point, defaults);
  Drop drop;
  geometry::GeneratorOptions hexapod;
  hexapod.shape = "hexapod";
  drop.shape = prepare(hexapod, kFinestPrepared, setup);
  drop.extent = 2.0;
  drop.count = 10;
  Json record;
  time_runs(
      [&] {
        World world = world_with_floor(setup);
        add_drop(world, drop);
        return world;
      },
      3.0, point["repeats"], record);
  return record;
}

Outcome conclude(const std::vector<Record>& records, Effort /*effort*/) {
  Outcome outcome;
  const std::vector<Record> shown = select(records, {{"friction", 0.3}});
  for (const Record& c : select(shown, {{"method", "C"}, {"model", "spheres"}})) {
    const Record& a = pick(shown, {{"method", "A"}, {"model", "spheres"}, {"level", c["level"]}});
    const double ratio = a["impulse_least_ms"].get<double>() / c["impulse_least_ms"].get<double>();
    outcome.verdicts.push_back(
        at_most(fmt::format("impulse time of A / C at level {} (far below)", c["level"].get<int>()),
                ratio, c["level"].get<int>() <= 3 ? 0.7 : 0.3));
  }
  outcome.plots.push_back(by_level(shown, "total_ms", "", "Ten hexapods: computing time, mu = 0.3",
                                   "time for 3 s [ms]", true));
  outcome.plots.push_back(by_level(shown, "impulse_ms", "",
                                   "Ten hexapods: time for the impulses, mu = 0.3",
                                   "time for 3 s [ms]", true));
  outcome.tables.push_back(
      level_table(shown, "total_ms", "Table 6-5", "Computing time of ten hexapods [ms], mu = 0.3"));
  outcome.tables.push_back(level_table(shown, "detection_ms", "Table 6-5", "Detection alone [ms]"));
  outcome.tables.push_back(level_table(shown, "impulse_ms", "Table 6-5", "Impulses alone [ms]"));
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
