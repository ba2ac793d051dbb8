// Fig. 4-10: do bodies that meet fast pass through each other, and how deep are they when they
// turn?
#include <fmt/format.h>

#include <algorithm>

#include "gotai/core/random.h"
#include "gotai/world/true_overlap.h"
#include "thesis/catalogue.h"
#include "thesis/scenario.h"

namespace gotai::experiments {
namespace {

constexpr double kSpeed = 5.0;      // of each of the two [m/s]
constexpr double kExtent = 2.0;     // L of the hexapod [m]
constexpr double kFineStep = 1e-4;  // where depths are measured [s]
constexpr int kMeetings = 8;        // of the depths, by seed

std::shared_ptr<const voxel::Shape> hexapod(const Setup& setup) {
  geometry::GeneratorOptions options;
  options.shape = "hexapod";
  return prepare(options, kFinestPrepared, setup);
}

/// Two hexapods in free space that fly at each other, turned and set aside at random.
struct Meeting {
  World world;
  double start;  ///< distance of each from the middle [m]
};

/// @param reach  how much farther than 2.2 m off each may start [m]
Meeting meeting(const Setup& setup, Random& random, double reach) {
  model::Settings settings = settings_of(setup);
  settings.gravity.setZero();
  World world(settings);
  model::Material material;
  material.restitution = setup.restitution;
  material.friction = 0.0;
  world.set_default_material(material);
  const ShapeId id = world.add_shape(hexapod(setup));
  const double y = random.uniform(-0.2, 0.2);
  const double z = random.uniform(-0.2, 0.2);
  const double start = 2.2 + random.uniform(0.0, reach);
  const Quat first = random.rotation();
  const Quat second = random.rotation();
  add_unit_body(world, id, Vec3(-start, 0.0, 0.0), first, Vec3(kSpeed, 0.0, 0.0));
  add_unit_body(world, id, Vec3(start, y, z), second, Vec3(-kSpeed, 0.0, 0.0));
  return {std::move(world), start};
}

Json count_crossings(const Json& point, Setup setup) {
  setup.dt = point["safety"].get<double>() *
             hexapod(setup)->pyramid.grid.voxel_radius(setup.level) / kSpeed;
  int crossed = 0;
  int missed = 0;
  double energy_ratio = 0.0;
  Random random(11);
  const int runs = point["runs"];
  for (int k = 0; k < runs; ++k) {
    auto [world, start] = meeting(setup, random, 2.0 * setup.dt * kSpeed);
    const double before = world.energy().total();
    bool touched = false;
    world.add_observer([&](const World&, const model::StepReport& report) {
      touched = touched || report.contacts > 0;
    });
    world.run_until(2.0 * start / kSpeed);
    if (!touched) ++missed;
    if (world.bodies().x_W[0].x() > world.bodies().x_W[1].x()) ++crossed;
    energy_ratio = std::max(energy_ratio, world.energy().total() / before);
  }
  return {{"crossed", crossed}, {"undetected", missed}, {"energy_ratio_max", energy_ratio}};
}

/// How deep the true meshes overlap when the first impulse acts: exact contact would turn them at
/// 0, so this error refers to the meshes and not to any level.
Json depth_of_turning(const Json& point, Setup setup) {
  setup.dt = kFineStep;
  Random random(point["seed"].get<std::uint64_t>());
  World world = meeting(setup, random, 0.0).world;
  const Vec3 unhurt = world.bodies().v_W[0];
  Snapshot before = world.snapshot();
  while (world.time() < 2.0 && world.bodies().v_W[0] == unhurt) {
    before = world.snapshot();
    world.step();
  }
  const double turned_at = world.time();
  world.restore(before);
  const TrueOverlap overlap = measure_true_overlap(world.bodies(), world.shapes());
  return {{"turned_s", turned_at}, {"error", overlap.max_m / kExtent}};
}

Json run(const Json& point, const std::string& /*folder*/) {
  Setup setup;
  setup.restitution = 0.5;
  setup = setup_of(point, setup);
  return point["measure"] == "depth" ? depth_of_turning(point, setup)
                                     : count_crossings(point, setup);
}

void judge_depths(Outcome& outcome, const std::vector<Record>& records) {
  Series series{"median over the meetings", {}, {}, true, false};
  for (int level = kCoarsestSurface; level <= 6; ++level) {
    std::vector<double> depths;
    for (const Record& r : select(records, {{"measure", "depth"}, {"level", level}}))
      depths.push_back(r["error"]);
    series.x.push_back(level);
    series.y.push_back(median(depths));
  }
  outcome.verdicts.push_back(
      falls_with_level("surface model: overlap of the true meshes when they turn [L]", series.y,
                       2.0 * kSpeed * kFineStep / kExtent));
  outcome.plots.push_back({"",
                           "Surface model: overlap of the true meshes when they turn",
                           "level",
                           "overlap [L]",
                           false,
                           true,
                           {series}});
}

Outcome conclude(const std::vector<Record>& records, Effort /*effort*/) {
  Outcome outcome;
  Table table{
      "",
      "Two hexapods at 10 m/s closing speed: how many pass through each other",
      {{"model", "safety factor", "runs", "changed sides", "undetected", "most energy / start"}}};
  Plot plot{"Fig. 4-10",
            "Bodies that pass through each other",
            "safety factor on the step of (4.29)",
            "changed sides / runs",
            false,
            false,
            {}};
  for (const char* model : {"spheres", "surface"}) {
    Series series;
    series.label = model;
    for (const Record& r : select(records, {{"model", model}, {"measure", "crossings"}})) {
      const double share = r["crossed"].get<double>() / r["runs"].get<double>();
      series.x.push_back(r["safety"]);
      series.y.push_back(share);
      table.rows.push_back({model, fmt::format("{:g}", r["safety"].get<double>()),
                            std::to_string(r["runs"].get<int>()),
                            std::to_string(r["crossed"].get<int>()),
                            std::to_string(r["undetected"].get<int>()),
                            fmt::format("{:.3f}", r["energy_ratio_max"].get<double>())});
      if (r["safety"].get<double>() <= 0.5)
        outcome.verdicts.push_back(at_most(
            fmt::format("pass-throughs at the derived step, {}", model), r["crossed"], 0.0));
    }
    plot.series.push_back(series);
  }
  outcome.plots.push_back(plot);
  judge_depths(outcome, records);
  outcome.tables.push_back(table);
  return outcome;
}

std::vector<Json> sweep(Effort effort) {
  std::vector<Json> points;
  for (const char* model : {"spheres", "surface"})
    for (const double safety : {0.5, 1.0, 2.0, 4.0, 8.0, 12.0}) {
      // Beyond the bound bodies overlap deeply and every step has thousands of contacts.
      if (effort == Effort::quick && safety > 2.0) continue;
      points.push_back({{"method", "C"},
                        {"model", model},
                        {"level", 4},
                        {"safety", safety},
                        {"measure", "crossings"},
                        {"runs", effort == Effort::quick ? 4 : 30}});
    }
  for (int seed = 1; seed <= kMeetings; ++seed)
    for (int level = kCoarsestSurface; level <= 6; ++level)
      points.push_back({{"method", "C"},
                        {"model", "surface"},
                        {"level", level},
                        {"seed", seed},
                        {"measure", "depth"}});
  return points;
}

}  // namespace

Experiment tunnel() {
  return {"tunnelling",
          "Fig. 4-10",
          "Do fast bodies pass through each other?",
          "Two hexapods meet at 10 m/s with random orientations, the step sigma times the bound of "
          "(4.29). The bound is tight: at the derived step (sigma = 0.5) none pass. How deep the "
          "true meshes overlap when the surface model turns them falls with its level.",
          false,
          sweep,
          run,
          conclude};
}

}  // namespace gotai::experiments
