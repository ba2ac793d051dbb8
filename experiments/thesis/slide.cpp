// Figs. 6-6..6-8, Tables 6-3, 6-4: a hexapod slides on three legs until friction stops it.
#include <fmt/format.h>

#include "thesis/catalogue.h"
#include "thesis/scenario.h"

namespace gotai::experiments {
namespace {

constexpr double kSpeed = 3.0;                // at the start [m/s]
constexpr double kStep = 1.0 / 200.0;         // [s]
constexpr double kDuration = 2.0;             // [s]
constexpr double kStoppingDistance = 1.5306;  // v^2 / (2 mu g) [m]

std::vector<Json> sweep(Effort effort) {
  std::vector<Json> points;
  const int finest = effort == Effort::quick ? 5 : 7;
  for (const char* model : {"spheres", "surface"})
    for (const char* method : {"C", "A", "I"})
      for (int level = 3; level <= finest; ++level)
        points.push_back({{"method", method},
                          {"model", model},
                          {"level", level},
                          {"repeats", effort == Effort::quick ? 3 : 5}});
  return points;
}

Json run(const Json& point, const std::string& /*folder*/) {
  Setup defaults;
  defaults.dt = kStep;
  defaults.restitution = 0.0;
  defaults.friction = 0.3;
  const Setup setup = setup_of(point, defaults);
  geometry::GeneratorOptions hexapod;
  hexapod.shape = "hexapod";
  const std::shared_ptr<const voxel::Shape> shape = prepare(hexapod, setup.level, setup);
  const Quat upright = Quat::FromTwoVectors(Vec3(1.0, 1.0, 1.0).normalized(), Vec3::UnitZ());
  const double height = touching_height(*shape, upright, setup);
  const auto start = [&](World& world) {
    return add_unit_body(world, world.add_shape(shape), Vec3(0.0, 0.0, height), upright,
                         Vec3(kSpeed, 0.0, 0.0));
  };
  Json record;
  time_runs(
      [&] {
        World world = world_with_floor(setup);
        start(world);
        return world;
      },
      kDuration, point["repeats"], record);
  World world = world_with_floor(setup);
  const BodyId body = start(world);
  Totals totals(world);
  std::vector<double> t;
  std::vector<double> x;
  world.add_observer([&](const World& w, const model::StepReport& report) {
    t.push_back(report.time);
    x.push_back(w.bodies().x_W[w.index(body)].x());
  });
  world.run_until(kDuration);
  record["distance"] = x.back();
  record["lateral"] = world.bodies().x_W[world.index(body)].y();
  record["tests_mean"] = static_cast<double>(totals.tests) / static_cast<double>(t.size());
  record["curves"] = {{"t", t}, {"x", x}};
  return record;
}

Outcome conclude(const std::vector<Record>& records, Effort /*effort*/) {
  Outcome outcome;
  for (const char* model : {"spheres", "surface"})
    for (const Record& r : select(records, {{"method", "C"}, {"model", model}}))
      if (r["level"].get<int>() >= 4)
        outcome.verdicts.push_back(
            within(fmt::format("stopping distance, {}, level {}", model, r["level"].get<int>()),
                   r["distance"], kStoppingDistance, 0.01));
  // The exact distance with steps of dt is v^2 / (2 mu g) less half a step of the start.
  std::vector<double> surface;
  const double scheme = kStoppingDistance - 0.5 * kStep * kSpeed;
  for (const Record& r : select(records, {{"method", "C"}, {"model", "surface"}}))
    surface.push_back(std::abs(r["distance"].get<double>() - scheme));
  outcome.verdicts.push_back(
      falls_with_level("surface model: distance beside the scheme's own [m]", surface, 1e-4));
  show_times(outcome, records, "Sliding hexapod", kDuration, "Table 6-3", "Table 6-4");
  Plot path{"", "Sliding hexapod: distance by time", "time [s]", "x [m]", false, false, {}};
  for (const Record& r : select(records, {{"method", "C"}}))
    path.series.push_back(
        {fmt::format("{}, level {}", r["model"].get<std::string>(), r["level"].get<int>()),
         r["curves"]["t"], r["curves"]["x"], false, r["model"].get<std::string>() == "surface"});
  outcome.plots.push_back(path);
  outcome.plots.push_back(by_level(records, "contacts_mean", "Fig. 6-8",
                                   "Sliding hexapod: contacts (why a coarser level can cost more)",
                                   "mean contacts", true));
  outcome.plots.push_back(by_level(records, "tests_mean", "Fig. 6-8",
                                   "Sliding hexapod: tests per step", "mean tests", true));
  outcome.tables.push_back(level_table(records, "distance", "", "Stopping distance [m]"));
  return outcome;
}

}  // namespace

Experiment slide() {
  return {"slide",
          "Figs. 6-6..6-8, Tables 6-3, 6-4",
          "A hexapod slides on three legs",
          "A hexapod stands on three legs, (1, 1, 1) up, and starts at 3 m/s (mu = 0.3, e = 0, dt "
          "= 1/200). "
          "Coulomb friction stops it after v^2 / (2 mu g) = 1.5306 m. At level 3 only the 8 core "
          "voxels "
          "exist, so it has no legs to stand on.",
          true,
          sweep,
          run,
          conclude};
}

}  // namespace gotai::experiments
