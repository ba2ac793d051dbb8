// Figs. 6-28, 6-29: constraint-based animation in real time on several processors, with the same
// bits.
#include <fmt/format.h>

#include <thread>

#include "gotai/core/parallel.h"
#include "thesis/catalogue.h"
#include "thesis/drops.h"
#include "thesis/level_error.h"

namespace gotai::experiments {
namespace {

/// 1, 2, 4, ..: more than there are processors must not change a bit, either.
std::vector<int> thread_counts(Effort effort) {
  const int processors = static_cast<int>(std::thread::hardware_concurrency());
  std::vector<int> counts{1, 2, 4};
  if (effort == Effort::full)
    for (int n = 8; n <= processors; n *= 2) counts.push_back(n);
  return counts;
}

std::vector<Json> sweep(Effort effort) {
  std::vector<Json> points;
  const double duration = effort == Effort::quick ? 0.5 : 3.0;
  for (const char* model : {"spheres", "surface"})
    for (const char* scene : {"blocks", "rocks"})
      for (const char* method : {"C", "A"}) {
        if (std::string(model) == "surface" && std::string(method) == "A") continue;
        for (const int threads : thread_counts(effort))
          points.push_back({{"method", method},
                            {"model", model},
                            {"level", 4},
                            {"scene", scene},
                            {"measure", "speed"},
                            {"threads", threads},
                            {"duration", duration}});
      }
  for (const char* scene : {"blocks", "rocks"})
    add_level_error_points(points, effort == Effort::quick ? 3 : 8, {{"scene", scene}});
  return points;
}

Setup base_setup() {
  Setup setup;
  setup.dt = 0.01;
  setup.restitution = 0.3;
  setup.friction = 0.3;
  setup.reduced = setup.substepped = true;
  return setup;
}

LevelErrorScene error_scene(const std::string& scene) {
  const auto make = [scene](const Setup& setup, std::uint64_t seed) {
    World world = world_with_floor(setup);
    add_crowd(world, scene, setup, seed);
    return world;
  };
  return {"parallel " + scene, make, base_setup(), 1.0, 0.7};
}

Json run(const Json& point, const std::string& /*folder*/) {
  if (point["measure"] == "error") return run_level_error(point, error_scene(point["scene"]));
  const Setup setup = setup_of(point, base_setup());
  const ThreadLimit limit(point["threads"].get<int>());
  World world = world_with_floor(setup);
  add_crowd(world, point["scene"], setup);
  Totals totals(world);
  world.run_until(point["duration"].get<double>());
  Json record;
  totals.write(record);
  record["steps_per_s"] = static_cast<double>(record["steps"].get<int>()) / totals.total_s;
  record["real_time_factor"] = record["steps_per_s"].get<double>() * setup.dt;
  record["state_hash"] = world.state_hash().hex();
  return record;
}

Outcome conclude(const std::vector<Record>& records, Effort /*effort*/) {
  Outcome outcome;
  Table table{"",
              "Steps per second and speed-up",
              {{"scene", "method", "model", "threads", "steps/s", "speed-up", "real time factor"}}};
  const std::vector<Record> runs = select(records, {{"measure", "speed"}});
  for (const Record& r : runs) {
    const Record& one = pick(
        runs,
        {{"scene", r["scene"]}, {"method", r["method"]}, {"model", r["model"]}, {"threads", 1}});
    const double speed_up = r["steps_per_s"].get<double>() / one["steps_per_s"].get<double>();
    if (r["threads"] != 1)
      outcome.verdicts.push_back(
          holds(fmt::format("{}, {}, {}: bitwise equal for 1 and {} threads",
                            r["scene"].get<std::string>(), r["method"].get<std::string>(),
                            r["model"].get<std::string>(), r["threads"].get<int>()),
                r["state_hash"] == one["state_hash"], r["state_hash"]));
    table.rows.push_back(
        {r["scene"], r["method"], r["model"], std::to_string(r["threads"].get<int>()),
         fmt::format("{:.0f}", r["steps_per_s"].get<double>()), fmt::format("{:.2f}", speed_up),
         fmt::format("{:.2f}", r["real_time_factor"].get<double>())});
  }
  outcome.tables.push_back(table);
  for (const char* scene : {"blocks", "rocks"})
    judge_level_error(outcome, select(records, {{"measure", "error"}, {"scene", scene}}), scene);
  for (const char* scene : {"blocks", "rocks"}) {
    Plot plot{std::string(scene) == "blocks" ? "Fig. 6-28" : "Fig. 6-29",
              fmt::format("Steps per second, {}", scene),
              "threads",
              "steps/s",
              false,
              false,
              {}};
    for (const Json& line :
         {Json{{"method", "C"}, {"model", "spheres"}}, Json{{"method", "A"}, {"model", "spheres"}},
          Json{{"method", "C"}, {"model", "surface"}}}) {
      Series series;
      series.label = label_of(line);
      Json match = line;
      match["scene"] = scene;
      for (const Record& r : select(runs, match)) {
        series.x.push_back(r["threads"]);
        series.y.push_back(r["steps_per_s"]);
      }
      plot.series.push_back(series);
    }
    outcome.plots.push_back(plot);
  }
  return outcome;
}

}  // namespace

Experiment parallel() {
  return {"parallel",
          "Figs. 6-28, 6-29",
          "Several processors: speed and equal bits",
          "27 boxes with 8 hexapods, and 64 rocks, at level 4. The thesis ran these on the Cell "
          "processor; "
          "here threads share the pairs and bodies, and the trajectory has the same bits for any "
          "number "
          "of them.",
          true,
          sweep,
          run,
          conclude};
}

}  // namespace gotai::experiments
