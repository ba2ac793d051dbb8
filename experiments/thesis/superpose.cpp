// Fig. 4-7: one impact of a flat cube; what several contacts do to impulses that know nothing of
// each other.
#include <fmt/format.h>

#include "thesis/catalogue.h"
#include "thesis/scenario.h"

namespace gotai::experiments {
namespace {

std::vector<Json> sweep(Effort /*effort*/) {
  std::vector<Json> points;
  for (const char* method : {"C", "S", "I", "A"})
    for (int level = 1; level <= 5; ++level)
      points.push_back({{"method", method}, {"model", "spheres"}, {"level", level}});
  for (int level = kCoarsestSurface; level <= 5; ++level)
    points.push_back({{"method", "C"}, {"model", "surface"}, {"level", level}});
  return points;
}

Json run(const Json& point, const std::string& /*folder*/) {
  Setup defaults;
  defaults.dt = 1e-6;  // gravity adds 1e-5 m/s during the impact
  const Setup setup = setup_of(point, defaults);
  World world = world_with_floor(setup);
  geometry::GeneratorOptions cube;
  cube.shape = "cube";
  const std::shared_ptr<const voxel::Shape> prepared = prepare(cube, kFinestPrepared, setup);
  const ShapeId shape = world.add_shape(prepared);
  const double touch = touching_height(*prepared, Quat::Identity(), setup);
  const BodyId body = add_unit_body(world, shape, Vec3(0.0, 0.0, touch - 1e-9), Quat::Identity(),
                                    Vec3(0.0, 0.0, -1.0));
  const model::StepReport report = world.step();
  Json record;
  record["v_after"] = world.bodies().v_W[world.index(body)].z();
  record["contacts"] = report.contacts;
  return record;
}

Outcome conclude(const std::vector<Record>& records, Effort /*effort*/) {
  Outcome outcome;
  const auto expect = [&](const char* method, const char* model,
                          const std::vector<double>& values) {
    for (std::size_t k = 0; k < values.size(); ++k) {
      const int level = static_cast<int>(k) + 1;
      const Record& r = pick(records, {{"method", method}, {"model", model}, {"level", level}});
      outcome.verdicts.push_back(within(fmt::format("v' of {}, {}, level {}", method, model, level),
                                        r["v_after"], values[k], 0.02));
    }
  };
  expect("S", "spheres", {0.5, 2.43, 12.48, 52.4, 212.0});
  expect("I", "spheres", {0.5, -0.143, -0.158, -0.166, -0.168});
  expect("C", "spheres", {0.5, 0.5, 0.5, 0.5, 0.5});
  expect("A", "spheres", {0.5, 0.5, 0.5, 0.5, 0.5});
  for (const Record& r : select(records, {{"model", "surface"}}))
    outcome.verdicts.push_back(within(
        fmt::format("v' of C, surface, level {}", r["level"].get<int>()), r["v_after"], 0.5, 0.02));
  std::vector<double> surface;
  for (const Record& r : select(records, {{"model", "surface"}}))
    surface.push_back(std::abs(r["v_after"].get<double>() - 0.5));
  outcome.verdicts.push_back(
      falls_with_level("surface model: error of v', exactly 0.5 [m/s]", surface, 2e-5));
  Table table{"",
              "Velocity after the impact of a flat cube (v = -1, e = 0.5)",
              {{"method", "model", "level", "contacts", "v' [m/s]"}}};
  for (const Record& r : records)
    table.rows.push_back({r["method"], r["model"], std::to_string(r["level"].get<int>()),
                          std::to_string(r["contacts"].get<int>()),
                          fmt::format("{:.4f}", r["v_after"].get<double>())});
  outcome.tables.push_back(table);
  Plot plot{"Fig. 4-7", "Velocity after the impact", "level", "|v'| / |v|", false, true, {}};
  for (const char* method : {"C", "S", "I"}) {
    Series series;
    series.label = method;
    for (const Record& r : select(records, {{"method", method}, {"model", "spheres"}})) {
      series.x.push_back(r["level"]);
      series.y.push_back(std::abs(r["v_after"].get<double>()));
    }
    plot.series.push_back(series);
  }
  outcome.plots.push_back(plot);
  return outcome;
}

}  // namespace

Experiment superpose() {
  return {
      "superpose",
      "Fig. 4-7",
      "One impact with many contacts",
      "A flat cube meets the floor at 1 m/s with e = 0.5. With impulses computed for every contact "
      "on its own, superposing them throws the cube off, and dividing them by their number leaves "
      "it approaching; the constraint-based method gives 0.5 m/s at every level.",
      false,
      sweep,
      run,
      conclude};
}

}  // namespace gotai::experiments
