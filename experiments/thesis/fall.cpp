// Figs. 4-4..4-6: a cube falls flat on the floor, at every level, against the analytic solution.
#include <fmt/format.h>

#include "thesis/catalogue.h"
#include "thesis/scenario.h"

namespace gotai::experiments {
namespace {

constexpr double kDuration = 2.0;
constexpr double kStart = 2.0;  // height of the centre of mass [m]

std::vector<Json> sweep(Effort /*effort*/) {
  std::vector<Json> points;
  for (const char* method : {"C", "S", "I"})
    for (int level = 1; level <= 5; ++level)
      points.push_back({{"method", method},
                        {"model", "spheres"},
                        {"level", level},
                        {"integrator", "semi-implicit"}});
  for (int level = 1; level <= 5; ++level)
    points.push_back({{"method", "C"},
                      {"model", "spheres"},
                      {"level", level},
                      {"integrator", "explicit-euler"}});
  for (int level = kCoarsestSurface; level <= 5; ++level)
    points.push_back(
        {{"method", "C"}, {"model", "surface"}, {"level", level}, {"integrator", "semi-implicit"}});
  return points;
}

Json run(const Json& point, const std::string& /*folder*/) {
  Setup defaults;
  defaults.dt = 1e-3;
  const Setup setup = setup_of(point, defaults);
  World world = world_with_floor(setup);
  geometry::GeneratorOptions cube;
  cube.shape = "cube";
  const ShapeId shape = world.add_shape(prepare(cube, setup.level, setup.model));
  const BodyId body = add_unit_body(world, shape, Vec3(0.0, 0.0, kStart));
  std::vector<double> t;
  std::vector<double> z;
  std::vector<double> exact;
  world.add_observer([&](const World& w, const model::StepReport& report) {
    t.push_back(report.time);
    z.push_back(w.bodies().x_W[w.index(body)].z());
    exact.push_back(bouncing_height(kStart, 0.5, setup.restitution, report.time));
  });
  Totals totals(world);
  world.run_until(kDuration);
  Json record;
  record["rms"] = rms(z, exact);
  totals.write(record);
  record["curves"] = {{"t", t}, {"z", z}, {"exact", exact}};
  return record;
}

Plot curves_plot(const std::vector<Record>& records, const std::string& method,
                 const std::string& model, const std::string& figure) {
  Plot plot{figure,     "Free fall of a cube, " + method + ", " + model,
            "time [s]", "height of the centre of mass [m]",
            false,      false,
            {}};
  const Record& first = pick(records, {{"method", method}, {"model", model}});
  plot.series.push_back({"exact", first["curves"]["t"], first["curves"]["exact"], false, true});
  for (const Record& r :
       select(records, {{"method", method}, {"model", model}, {"integrator", "semi-implicit"}}))
    plot.series.push_back({fmt::format("level {}", r["level"].get<int>()), r["curves"]["t"],
                           r["curves"]["z"], false, false});
  return plot;
}

Outcome conclude(const std::vector<Record>& records, Effort /*effort*/) {
  Outcome outcome;
  const auto expect = [&](Json match, const std::vector<double>& values, double tolerance) {
    for (std::size_t k = 0; k < values.size(); ++k) {
      match["level"] = static_cast<int>(k) + 1;
      outcome.verdicts.push_back(
          within("RMS " + match.dump(), pick(records, match)["rms"], values[k], tolerance));
    }
  };
  const Json spheres{{"model", "spheres"}, {"integrator", "semi-implicit"}};
  const auto with_method = [&](const char* method) {
    Json match = spheres;
    match["method"] = method;
    return match;
  };
  expect(with_method("C"), {0.2905, 0.1464, 0.0730, 0.0359, 0.0177}, 0.03);
  expect(with_method("S"), {0.291, 5.3, 44.0, 197.0, 812.0}, 0.05);
  expect(with_method("I"), {0.291, 0.127, 0.114, 0.127, 0.137}, 0.05);
  expect({{"method", "C"}, {"model", "spheres"}, {"integrator", "explicit-euler"}},
         {0.287, 0.143, 0.070, 0.033, 0.0145}, 0.05);
  for (const Record& r : select(records, {{"model", "surface"}}))
    outcome.verdicts.push_back(at_most(
        fmt::format("RMS of the surface model, level {}", r["level"].get<int>()), r["rms"], 0.002));

  outcome.plots.push_back(curves_plot(records, "C", "spheres", "Fig. 4-5"));
  outcome.plots.push_back(curves_plot(records, "I", "spheres", "Fig. 4-6"));
  outcome.plots.push_back(curves_plot(records, "C", "surface", ""));
  Plot levels{"Fig. 4-4", "Error by level", "level", "RMS error [m]", false, true, {}};
  for (const Json& match :
       {Json{{"method", "C"}, {"model", "spheres"}, {"integrator", "semi-implicit"}},
        Json{{"method", "S"}, {"model", "spheres"}}, Json{{"method", "I"}, {"model", "spheres"}},
        Json{{"method", "C"}, {"model", "surface"}}}) {
    Series series;
    for (const Record& r : select(records, match)) {
      series.label = label_of(r);
      series.x.push_back(r["level"]);
      series.y.push_back(r["rms"]);
    }
    levels.series.push_back(series);
  }
  outcome.plots.push_back(levels);
  return outcome;
}

}  // namespace

Experiment fall() {
  return {
      "fall",
      "Figs. 4-4..4-6",
      "Free fall of a cube on the floor, by level",
      "A cube of edge 1 falls flat from a height of 2 m (e = 0.5, no friction, dt = 1/1000, 2 s). "
      "The constraint-based method converges with the level, because its error is the offset of "
      "the voxel spheres, which halves with each level. Superposed impulses explode and averaged "
      "ones do not converge. The surface model has no offset.",
      false,
      sweep,
      run,
      conclude};
}

}  // namespace gotai::experiments
