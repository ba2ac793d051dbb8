// Figs. 6-4, 6-5, Tables 6-1, 6-2: what a falling sphere costs, in all and for the impulses alone.
#include <fmt/format.h>

#include <utility>

#include "thesis/catalogue.h"
#include "thesis/scenario.h"

namespace gotai::experiments {
namespace {

constexpr double kStart = 2.0;     // height of the centre of mass [m]
constexpr double kDuration = 3.0;  // [s]

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

/// Runs the fall once more beside what is timed and writes its error: the root mean square of the
/// height over the run, against the exact bounces of the true ball and against the scheme's own.
/// The start has half a step of gravity in it, as the scheme's velocities belong to half steps.
void measure_error(const Setup& setup, const voxel::Shape& shape, World world, BodyId body,
                   Json& record) {
  Setup true_surface = setup;
  true_surface.model = "surface";
  const double z_touch = touching_height(shape, Quat::Identity(), true_surface);
  std::vector<double> z;
  std::vector<double> exact;
  world.add_observer([&](const World& w, const model::StepReport& report) {
    z.push_back(w.bodies().x_W[w.index(body)].z());
    exact.push_back(bouncing_height(kStart, z_touch, setup.restitution, report.time));
  });
  world.run_until(kDuration);
  const double v0 = 0.5 * kGravity * setup.dt;
  std::vector<double> scheme =
      scheme_heights(kStart, z_touch, v0, setup.restitution, setup.dt, kDuration);
  scheme.resize(z.size());
  record["error"] = rms(z, exact);
  record["error_beside_scheme"] = rms(z, scheme);
}

Json run(const Json& point, const std::string& /*folder*/) {
  Setup defaults;
  defaults.dt = 1.0 / 200.0;
  const Setup setup = setup_of(point, defaults);
  geometry::GeneratorOptions sphere;
  sphere.shape = "sphere";
  const std::shared_ptr<const voxel::Shape> shape = prepare(sphere, setup.level, setup);
  const auto ball = [&](World& world) {
    return add_unit_body(world, world.add_shape(shape), Vec3(0.0, 0.0, kStart), Quat::Identity(),
                         Vec3(0.0, 0.0, 0.5 * kGravity * setup.dt));
  };
  Json record;
  time_runs(
      [&] {
        World world = world_with_floor(setup);
        ball(world);
        return world;
      },
      kDuration, point["repeats"], record);
  World world = world_with_floor(setup);
  const BodyId body = ball(world);
  measure_error(setup, *shape, std::move(world), body, record);
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
  std::vector<double> surface;
  for (const Record& r : select(records, {{"method", "C"}, {"model", "surface"}}))
    surface.push_back(r["error_beside_scheme"]);
  outcome.verdicts.push_back(falls_with_level(
      "surface model: error beside the scheme's own, which knows no level [m]", surface, 1e-9));
  show_times(outcome, records, "Falling sphere", kDuration, "Table 6-1", "Table 6-2");
  outcome.plots.push_back(by_level(records, "error", "",
                                   "Falling sphere: error of the height against the exact ball",
                                   "RMS error [m]", true));
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
      "median of the repeats, beside the contacts that they were spent on, and the error of the "
      "height against the exact bounces of the true ball.",
      true,
      sweep,
      run,
      conclude};
}

}  // namespace gotai::experiments
