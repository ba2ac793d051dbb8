// Figs. 6-1, 6-2, 6-4..6-7, 6-9..6-11, 6-17, 6-18, 6-27..6-29: starts, strips and playback of runs.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "gotai/render/moment.h"
#include "gotai/render/picture.h"
#include "gotai/render/renderer.h"
#include "gotai/view/pack.h"
#include "gotai/view/pack_run.h"
#include "gotai/view/page.h"
#include "report.h"
#include "thesis/catalogue.h"
#include "thesis/drops.h"

namespace gotai::experiments {
namespace {

/// A run of chapter 6.
struct Run {
  const char* figure;  ///< of the animation, "" when the thesis has none
  const char* start;   ///< figure of its start, ""
  const char* title;
  const char* scene;
  int level;
  int rate;  ///< steps per second
  double duration;
};

constexpr Run kRuns[] = {{"6-2", "6-1", "A thrown sphere", "throw", 5, 400, 2.0},
                         {"6-5", "6-4", "A falling sphere", "drop", 5, 200, 3.0},
                         {"6-7", "6-6", "A hexapod slides on the floor", "slide", 5, 200, 2.0},
                         {"6-10", "6-9", "Ten hexapods fall", "ten hexapods", 5, 100, 3.0},
                         {"", "6-11", "Four hexapods fall", "hexapods", 5, 100, 2.0},
                         {"6-18", "6-17", "Rocks fall", "four rocks", 5, 200, 2.0},
                         {"6-27", "6-26", "Bodies of many polygons fall", "polygons", 5, 200, 2.0},
                         {"6-28", "", "27 boxes and 8 hexapods", "blocks", 4, 100, 3.0},
                         {"6-29", "", "64 rocks", "rocks", 4, 100, 3.0}};

const Run& run_of(const Json& point) {
  for (const Run& run : kRuns)
    if (point["scene"] == run.scene) return run;
  return kRuns[0];
}

std::vector<Json> sweep(Effort /*effort*/) {
  std::vector<Json> points;
  for (const Run& run : kRuns)
    for (const char* model : {"spheres", "surface"})
      for (const char* method : {"C", "A"}) {
        const bool crowd = run.figure == std::string("6-28") || run.figure == std::string("6-29");
        const bool spheres = model == std::string("spheres");
        const bool apparent = method == std::string("A");
        // Figs. 6-28 and 6-29 compare C with A, the thesis's answer to many sphere contacts.
        if (apparent && !(crowd && spheres)) continue;
        points.push_back({{"scene", run.scene},
                          {"method", method},
                          {"model", model},
                          {"level", run.level},
                          {"duration", run.duration}});
      }
  return points;
}

void add_single(World& world, const char* shape_name, const Setup& setup, double height,
                const Quat& q_WB, const Vec3& v_W) {
  geometry::GeneratorOptions options;
  options.shape = shape_name;
  const auto shape = prepare(options, setup.level, setup);
  const double z = height > 0.0 ? height : touching_height(*shape, q_WB, setup);
  add_unit_body(world, world.add_shape(shape), Vec3(0.0, 0.0, z), q_WB, v_W);
}

void add_bodies(World& world, const std::string& scene, const Setup& setup) {
  if (scene == "throw")
    return add_single(world, "sphere", setup, 2.0, Quat::Identity(), Vec3(2.0, 0.0, 0.0));
  if (scene == "drop")
    return add_single(world, "sphere", setup, 2.0, Quat::Identity(), Vec3::Zero());
  if (scene == "slide")
    return add_single(world, "hexapod", setup, 0.0,
                      Quat::FromTwoVectors(Vec3(1.0, 1.0, 1.0).normalized(), Vec3::UnitZ()),
                      Vec3(3.0, 0.0, 0.0));
  if (scene == "blocks" || scene == "rocks") return add_crowd(world, scene, setup);
  geometry::GeneratorOptions options;
  options.shape = scene == "four rocks" || scene == "polygons" ? "rock" : "hexapod";
  if (scene == "polygons") options.subdivisions = 6;  // 81,920 triangles
  Drop drop;
  drop.shape = prepare(options, kFinestPrepared, setup);
  drop.extent = drop.shape->pyramid.grid.voxel_edge(1);
  drop.count = scene == "ten hexapods" ? 10 : scene == "polygons" ? 5 : 4;
  add_drop(world, drop);
}

/// A run held in memory, as the viewer and the renderer take it.
struct Film {
  view::RunView run;
  std::vector<view::FrameView> frames;
  std::vector<model::StepReport> steps;

  view::FrameSource source() const {
    view::FrameSource source;
    for (const view::FrameView& frame : frames) source.times.push_back(frame.time);
    source.read = [this](std::size_t k) { return frames[k]; };
    return source;
  }
};

Film film(World& world, const Run& run, double duration) {
  Film film;
  film.run = view::describe(world);
  film.run.title = run.title;
  film.frames.push_back(view::capture(world));
  world.add_observer(
      [&film](const World&, const model::StepReport& r) { film.steps.push_back(r); });
  const int count = static_cast<int>(30.0 * duration);
  for (int k = 1; k <= count; ++k) {
    world.run_until(k / 30.0);
    film.frames.push_back(view::capture(world));
  }
  return film;
}

std::string base64_of_png(const render::Picture& picture, const std::string& path) {
  render::write_png(path, picture);
  std::ifstream in(path, std::ios::binary);
  const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(in), {}};
  return view::to_base64(bytes);
}

/// Pictures of moments with one camera.
std::vector<render::Picture> pictures(const Film& film, const std::vector<double>& times, int width,
                                      int height) {
  render::RenderOptions options;
  options.width = width;
  options.height = height;
  render::Renderer renderer(film.run, options);
  const view::FrameSource source = film.source();
  std::vector<view::FrameView> moments;
  moments.reserve(times.size());
  for (const double t : times) moments.push_back(render::moment_at(source, t));
  const render::Extent extent = render::measure(film.run, moments);
  const render::Camera camera =
      render::frame_camera(extent, Vec3(0.35, -1.0, 0.3), static_cast<double>(width) / height, 1.0);
  std::vector<render::Picture> drawn;
  drawn.reserve(moments.size());
  for (const view::FrameView& moment : moments)
    drawn.push_back(renderer.draw(
        moment, render::body_colours(film.run, moment, render::ColourMode::index, extent.scales),
        camera, extent));
  return drawn;
}

Json run(const Json& point, const std::string& folder) {
  const Run& run = run_of(point);
  Setup defaults;
  defaults.dt = 1.0 / run.rate;
  const std::string scene = run.scene;
  const bool single = scene == "throw" || scene == "drop" || scene == "slide";
  defaults.restitution = scene == "slide" ? 0.0 : single ? 0.5 : 0.3;
  defaults.friction = scene == "throw" || scene == "drop" ? 0.0 : 0.3;
  defaults.reduced = defaults.substepped = !single;
  const Setup setup = setup_of(point, defaults);
  World world = world_with_floor(setup);
  add_bodies(world, scene, setup);
  const double duration = point["duration"];
  Totals totals(world);
  const Film shown = film(world, run, duration);

  Json record;
  totals.write(record);
  record["frames"] = shown.frames.size();
  record["real_time_factor"] = duration / totals.total_s;
  const std::vector<double> times{0.0, 0.25 * duration, 0.5 * duration, 0.75 * duration, duration};
  record["curves"]["strip"] = base64_of_png(
      render::side_by_side(pictures(shown, times, 230, 170), 4), folder + "/strip.png");
  record["curves"]["start"] =
      base64_of_png(pictures(shown, {0.0}, 420, 300).front(), folder + "/start.png");
  record["curves"]["run"] = "";
  if (view::page_template().empty()) return record;
  view::PackOptions packing;
  packing.page_bytes = 2'500'000;
  const std::vector<std::uint8_t> container =
      view::pack_run(shown.run, shown.source(), shown.steps, packing, {});
  record["curves"]["run"] = view::to_base64(view::deflate(container));
  write_text(folder + "/page.html", view::recorded_page(container));
  return record;
}

Outcome conclude(const std::vector<Record>& records, Effort /*effort*/) {
  Outcome outcome;
  Table table{"",
              "Runs",
              {{"figure", "run", "method", "model", "bodies' contacts, mean", "real time factor"}}};
  for (const Record& r : records) {
    const Run& run = run_of(r);
    const std::string model = r["model"];
    const std::string how = fmt::format("{}: {}, {}, level {}, dt = 1/{}", run.title,
                                        r["method"].get<std::string>(), model, run.level, run.rate);
    const std::string number = *run.figure != '\0' ? fmt::format("Fig. {}", run.figure) : "";
    if (*run.start != '\0' && model == "spheres")
      outcome.pictures.push_back({fmt::format("Fig. {}", run.start),
                                  std::string(run.title) + ": start", "", r["curves"]["start"]});
    outcome.animations.push_back({number, how, r["curves"]["strip"], r["curves"]["run"]});
    outcome.verdicts.push_back(
        holds(fmt::format("{} {}: a picture for every 1/30 s", number, how),
              r["frames"] == static_cast<int>(30.0 * r["duration"].get<double>()) + 1,
              fmt::format("{} frames", r["frames"].get<int>())));
    table.rows.push_back({number, run.title, r["method"], model,
                          fmt::format("{:.1f}", r["contacts_mean"].get<double>()),
                          fmt::format("{:.1f}", r["real_time_factor"].get<double>())});
  }
  outcome.tables.push_back(table);
  return outcome;
}

}  // namespace

Experiment animations() {
  return {"animations",
          "Figs. 6-1, 6-2, 6-4..6-7, 6-9..6-11, 6-17, 6-18, 6-26..6-29",
          "The animations of chapter 6: starts, strips, playback",
          "Each run of chapter 6 with the thesis's spheres and with the surface model: its start, "
          "a strip of five moments, and the run itself in the viewer.",
          false,
          sweep,
          run,
          conclude};
}

}  // namespace gotai::experiments
