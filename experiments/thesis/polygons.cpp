// Figs. 6-26, 6-27: detection does not know how many polygons a body has.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "gotai/core/parallel.h"
#include "gotai/core/stopwatch.h"
#include "thesis/catalogue.h"
#include "thesis/drops.h"
#include "thesis/level_error.h"

namespace gotai::experiments {
namespace {

constexpr int kLevel = 5;

constexpr int kSeeds = 8;         // of the error
constexpr int kCoarsestRock = 2;  // halvings: 320 triangles

std::vector<Json> sweep(Effort effort) {
  std::vector<Json> points;
  const std::vector<int> halvings =
      effort == Effort::quick ? std::vector{2, 4, 6} : std::vector{2, 4, 6, 7};
  // "same solid": the flat triangles of the coarsest rock are split, so that nothing but their
  // number changes. "smoother": the noise itself is sampled more finely, as a modeller would.
  for (const char* model : {"spheres", "surface"})
    for (const char* refinement : {"same solid", "smoother"})
      for (const int n : halvings)
        points.push_back({{"method", "C"},
                          {"model", model},
                          {"level", kLevel},
                          {"triangles", 20 << (2 * n)},
                          {"refinement", refinement},
                          {"halvings", n},
                          {"measure", "time"},
                          {"repeats", effort == Effort::quick ? 5 : 15}});
  add_level_error_points(points, kSeeds, {{"triangles", 20 << (2 * kCoarsestRock)}});
  return points;
}

/// Splits every triangle of a closed surface into four at the midpoints of its edges. The
/// tetrahedra fan from the origin, as those of a rock do.
geometry::Mesh split_triangles(const geometry::Mesh& coarse) {
  geometry::Mesh fine;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middle;
  fine.vertices = coarse.vertices;
  const auto midpoint = [&](std::uint32_t a, std::uint32_t b) {
    const auto [at, is_new] =
        middle.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(fine.vertices.size()));
    if (is_new) fine.vertices.push_back(0.5 * (fine.vertices[a] + fine.vertices[b]));
    return at->second;
  };
  for (const geometry::Triangle& t : coarse.triangles) {
    const std::uint32_t a = midpoint(t[0], t[1]);
    const std::uint32_t b = midpoint(t[1], t[2]);
    const std::uint32_t c = midpoint(t[2], t[0]);
    for (const geometry::Triangle& part :
         {geometry::Triangle{t[0], a, c}, {t[1], b, a}, {t[2], c, b}, {a, b, c}})
      fine.triangles.push_back(part);
  }
  return fine;
}

std::shared_ptr<const voxel::Shape> rock(int halvings, bool same_solid, const Setup& setup) {
  geometry::GeneratorOptions options;
  options.shape = "rock";
  options.subdivisions = same_solid ? kCoarsestRock : halvings;
  geometry::Mesh mesh = geometry::generate(options);
  if (same_solid) {
    mesh.tetrahedra.clear();
    for (int n = kCoarsestRock; n < halvings; ++n) mesh = split_triangles(mesh);
  }
  return prepare("rock", std::move(mesh), kFinestPrepared, setup);
}

World world_of(const Setup& setup, std::shared_ptr<const voxel::Shape> shape,
               std::uint64_t seed = 1) {
  World world = world_with_floor(setup);
  Drop drop;
  drop.extent = shape->pyramid.grid.voxel_edge(1);
  drop.shape = std::move(shape);
  drop.count = 5;
  drop.seed = seed;
  add_drop(world, drop);
  return world;
}

/// All states of one run, which every mesh then replays: chaos would change the contacts between
/// runs.
std::vector<Snapshot> recorded_run(const Setup& setup, bool same_solid) {
  World world = world_of(setup, rock(4, same_solid, setup));
  std::vector<Snapshot> states;
  while (world.time() < 2.0) {
    states.push_back(world.snapshot());
    world.step();
  }
  return states;
}

/// Detection alone over all states [ms of processor time]; counts the contacts.
double replay(World& world, const std::vector<Snapshot>& states, std::uint64_t& contacts) {
  collision::CollisionCache cache;
  model::ContactSet found;
  contacts = 0;
  double seconds = 0.0;
  for (const Snapshot& state : states) {
    world.restore(state);
    const double start = thread_seconds();
    collision::find_contacts(world.bodies(), world.shapes(), world.settings().collision, 0.0, cache,
                             found);
    seconds += thread_seconds() - start;
    contacts += found.size();
  }
  return 1e3 * seconds;
}

Setup base_setup() {
  Setup setup;
  setup.dt = 1.0 / 200.0;
  setup.restitution = 0.3;
  setup.friction = 0.3;
  setup.reduced = setup.substepped = true;
  return setup;
}

LevelErrorScene error_scene() {
  const auto make = [](const Setup& setup, std::uint64_t seed) {
    return world_of(setup, rock(kCoarsestRock, true, setup), seed);
  };
  const double extent = rock(kCoarsestRock, true, {})->pyramid.grid.voxel_edge(1);
  return {"polygons", make, base_setup(), extent, 1.0};
}

Json run(const Json& point, const std::string& /*folder*/) {
  if (point["measure"] == "error") return run_level_error(point, error_scene());
  const ThreadLimit one_thread(1);
  const Setup setup = setup_of(point, base_setup());
  const bool same_solid = point["refinement"] == "same solid";
  const std::vector<Snapshot> states = recorded_run(setup, same_solid);
  Json record;
  Stopwatch clock;
  World world = world_of(setup, rock(point["halvings"], same_solid, setup));
  record["prepare_s"] = clock.seconds();
  World coarsest = world_of(setup, rock(kCoarsestRock, same_solid, setup));
  // The coarsest mesh takes turns, so that what disturbs the machine disturbs both.
  std::vector<double> times;
  std::vector<double> ratios;
  std::uint64_t contacts = 0;
  std::uint64_t contacts_coarsest = 0;
  for (int k = 0; k < point["repeats"].get<int>(); ++k) {
    const double base = replay(coarsest, states, contacts_coarsest);
    times.push_back(replay(world, states, contacts));
    ratios.push_back(times.back() / base);
  }
  record["detection_ms"] = median(times);
  record["ratio"] = median(ratios);
  record["contacts_mean"] = static_cast<double>(contacts) / static_cast<double>(states.size());
  return record;
}

Outcome conclude(const std::vector<Record>& records, Effort /*effort*/) {
  Outcome outcome;
  const std::vector<Record> timed = select(records, {{"measure", "time"}});
  Plot plot{"Fig. 6-26",
            "Detection time by number of polygons",
            "triangles per body",
            "time / time of 320 triangles",
            true,
            false,
            {}};
  for (const char* model : {"spheres", "surface"})
    for (const char* refinement : {"same solid", "smoother"}) {
      Series series;
      series.label = fmt::format("{}, {}", model, refinement);
      series.dashed = std::string(refinement) == "smoother";
      for (const Record& r : select(timed, {{"model", model}, {"refinement", refinement}})) {
        series.x.push_back(r["triangles"]);
        series.y.push_back(r["ratio"]);
      }
      const auto [low, high] = std::minmax_element(series.y.begin(), series.y.end());
      if (!series.dashed)
        outcome.verdicts.push_back(
            at_most(fmt::format("detection time max / min over polygon counts, {}", model),
                    *high / *low, 1.2));
      plot.series.push_back(series);
    }
  outcome.plots.push_back(plot);
  judge_level_error(outcome, select(records, {{"measure", "error"}}), "five rocks");
  Table table{"",
              "Detection on one recorded trajectory (processor time)",
              {{"model", "refinement", "triangles", "preparation [s]", "detection [ms]",
                "time / time of 320", "mean contacts"}}};
  for (const Record& r : timed)
    table.rows.push_back({r["model"], r["refinement"], std::to_string(r["triangles"].get<int>()),
                          fmt::format("{:.2f}", r["prepare_s"].get<double>()),
                          fmt::format("{:.2f}", r["detection_ms"].get<double>()),
                          fmt::format("{:.2f}", r["ratio"].get<double>()),
                          fmt::format("{:.2f}", r["contacts_mean"].get<double>())});
  outcome.tables.push_back(table);
  return outcome;
}

}  // namespace

Experiment polygons() {
  return {"polygons",
          "Figs. 6-26, 6-27",
          "Detection time by number of polygons",
          "Five rocks of 320 to 327,680 triangles fall at level 5 (dt = 1/200, 2 s). Detection is "
          "timed on "
          "one recorded trajectory that every mesh replays. Its cost depends on the level and not "
          "on the "
          "polygons.",
          true,
          sweep,
          run,
          conclude};
}

}  // namespace gotai::experiments
