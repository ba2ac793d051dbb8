// Figs. 6-28, 6-29: constraint-based animation in real time on several processors, with the same
// bits.
#include <fmt/format.h>

#include <cmath>

#include "gotai/core/parallel.h"
#include "thesis/catalogue.h"
#include "thesis/drops.h"

namespace gotai::experiments {
namespace {

std::vector<Json> sweep(Effort effort) {
  std::vector<Json> points;
  const double duration = effort == Effort::quick ? 0.5 : 3.0;
  for (const char* model : {"spheres", "surface"})
    for (const char* scene : {"blocks", "rocks"})
      for (const char* method : {"C", "A"}) {
        if (std::string(model) == "surface" && std::string(method) == "A") continue;
        for (const int threads : {1, 2})
          points.push_back({{"method", method},
                            {"model", model},
                            {"level", 4},
                            {"scene", scene},
                            {"threads", threads},
                            {"duration", duration}});
      }
  return points;
}

Json run(const Json& point, const std::string& /*folder*/) {
  Setup defaults;
  defaults.dt = 0.01;
  defaults.restitution = 0.3;
  defaults.friction = 0.3;
  defaults.exact = false;
  const Setup setup = setup_of(point, defaults);
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
  for (const Record& r : records) {
    Json match = r;
    for (const char* key : {"steps", "contacts_mean", "contacts_max", "overlap_max", "energy_gain",
                            "steps_per_s", "real_time_factor", "state_hash"})
      match.erase(key);
    match["threads"] = 1;
    const Record& one = pick(records, match);
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
      for (const Record& r : select(records, match)) {
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
