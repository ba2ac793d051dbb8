#include "thesis/level_error.h"

#include <fmt/format.h>

#include <map>
#include <mutex>
#include <utility>

#include "gotai/core/parallel.h"
#include "gotai/core/random.h"
#include "thesis/drops.h"

namespace gotai::experiments {
namespace {

constexpr int kReferenceLevel = 6;
constexpr double kReferenceStep = 1.0 / 1000.0;
constexpr double kNudge = 1e-6;  // of the noise floor [m]

Trajectory run_scene(const LevelErrorScene& scene, int level, std::uint64_t seed, double nudge,
                     Json& record) {
  const ThreadLimit one_thread(1);
  Setup setup = scene.setup;
  setup.model = "surface";
  setup.level = level;
  setup.dt = kReferenceStep;
  setup.reduced = true;
  setup.substepped = false;
  World world = scene.make(setup, seed);
  if (nudge > 0.0) {
    Snapshot start = world.snapshot();
    Random random(seed);
    for (model::BodyIndex i = 0; i < world.bodies().size(); ++i)
      if (world.bodies().is_dynamic(i)) start.x_W[i] += nudge * random.unit_vector();
    world.restore(start);
  }
  Totals totals(world);
  Trajectory trajectory = sample(world, scene.window);
  totals.write(record);
  return trajectory;
}

/// Computed once per program, because every level is compared with it.
const Trajectory& reference(const LevelErrorScene& scene, std::uint64_t seed) {
  static std::mutex mutex;
  static std::map<std::pair<std::string, std::uint64_t>, Trajectory> known;
  const std::lock_guard lock(mutex);
  Trajectory& trajectory = known[{scene.id, seed}];
  Json unused;
  if (trajectory.empty()) trajectory = run_scene(scene, kReferenceLevel, seed, 0.0, unused);
  return trajectory;
}

double median_error(const std::vector<Record>& records) {
  std::vector<double> errors;
  errors.reserve(records.size());
  for (const Record& r : records) errors.push_back(r["error"]);
  return median(errors);
}

}  // namespace

void add_level_error_points(std::vector<Json>& points, int seeds, const Json& more) {
  for (int seed = 1; seed <= seeds; ++seed)
    for (int level = kCoarsestSurface; level <= kReferenceLevel; ++level) {
      Json point{{"method", level == kReferenceLevel ? "noise" : "C"},
                 {"model", "surface"},
                 {"level", level},
                 {"seed", seed},
                 {"measure", "error"}};
      point.update(more);
      points.push_back(point);
    }
}

Json run_level_error(const Json& point, const LevelErrorScene& scene) {
  Json record;
  const std::uint64_t seed = point["seed"];
  const double nudge = point["method"] == "noise" ? kNudge : 0.0;
  const Trajectory found = run_scene(scene, point["level"], seed, nudge, record);
  record["error"] = mean_error(found, reference(scene, seed), scene.extent);
  return record;
}

// Errors within three times of what a change by a rounding makes are all the same.
constexpr double kNoiseMargin = 3.0;

void judge_level_error(Outcome& outcome, const std::vector<Record>& records,
                       const std::string& what) {
  const double noise = median_error(select(records, {{"method", "noise"}}));
  Series levels{"surface, median over the seeds", {}, {}, true, false};
  for (int level = kCoarsestSurface; level < kReferenceLevel; ++level) {
    levels.x.push_back(level);
    levels.y.push_back(median_error(select(records, {{"method", "C"}, {"level", level}})));
  }
  outcome.verdicts.push_back(
      falls_with_level(fmt::format("surface model, {}: error against the surface at level {} [L]",
                                   what, kReferenceLevel),
                       levels.y, kNoiseMargin * noise, noise));
  Series floor{"noise floor", levels.x, std::vector<double>(levels.x.size(), noise), false, true};
  outcome.plots.push_back({"",
                           fmt::format("Surface model, {}: error by level", what),
                           "level",
                           "mean error [L]",
                           false,
                           true,
                           {levels, floor}});
}

}  // namespace gotai::experiments
