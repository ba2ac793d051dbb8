// Figs. 6-4, 6-5, Tables 6-1, 6-2: what a falling sphere costs, in all and for the impulses alone.
#include <fmt/format.h>

#include "thesis/catalogue.h"
#include "thesis/scenario.h"

namespace gotai::experiments {
namespace {

std::vector<Json> sweep(Effort effort) {
  std::vector<Json> points;
  const int finest = effort == Effort::quick ? 6 : 7;
  for (const char* model : {"spheres", "surface"})
    for (const char* method : {"C", "A", "I"})
      for (int level = 1; level <= finest; ++level) {
        if (level < kCoarsestSurface && std::string(model) == "surface") continue;
        points.push_back({{"method", method},
                          {"model", model},
                          {"level", level},
                          {"repeats", effort == Effort::quick ? 3 : 5}});
      }
  return points;
}

Json run(const Json& point, const std::string& /*folder*/) {
  Setup defaults;
  defaults.dt = 1.0 / 200.0;
  const Setup setup = setup_of(point, defaults);
  geometry::GeneratorOptions sphere;
  sphere.shape = "sphere";
  const std::shared_ptr<const voxel::Shape> shape = prepare(sphere, setup.level, setup);
  Json record;
  time_runs(
      [&] {
        World world = world_with_floor(setup);
        add_unit_body(world, world.add_shape(shape), Vec3(0.0, 0.0, 2.0));
        return world;
      },
      3.0, point["repeats"], record);
  return record;
}

Outcome conclude(const std::vector<Record>& records, Effort /*effort*/) {
  Outcome outcome;
  for (const char* method : {"C", "A", "I"}) {
    const Record& finest = pick(records, {{"method", method}, {"model", "spheres"}, {"level", 6}});
    outcome.verdicts.push_back(
        at_most(fmt::format("most contacts of {} at level 6 (grow slowly with the level)", method),
                finest["contacts_max"], 100.0));
  }
  outcome.plots.push_back(by_level(records, "total_ms", "", "Falling sphere: computing time",
                                   "time for 3 s [ms]", true));
  outcome.plots.push_back(by_level(records, "impulse_ms", "",
                                   "Falling sphere: time for the impulses", "time for 3 s [ms]",
                                   true));
  outcome.tables.push_back(
      level_table(records, "total_ms", "Table 6-1", "Computing time of the falling sphere [ms]"));
  outcome.tables.push_back(level_table(records, "impulse_ms", "Table 6-2",
                                       "Time for the impulses of the falling sphere [ms]"));
  outcome.tables.push_back(level_table(records, "contacts_max", "", "Most contacts at a time"));
  return outcome;
}

}  // namespace

Experiment drop_time() {
  return {
      "drop-time",
      "Figs. 6-4, 6-5, Tables 6-1, 6-2",
      "A falling sphere: computing time by level",
      "A sphere of diameter 1 falls from 2 m (e = 0.5, dt = 1/200, 3 s); times for one thread, the "
      "median of the repeats, beside the contacts that they were spent on.",
      true,
      sweep,
      run,
      conclude};
}

}  // namespace gotai::experiments
