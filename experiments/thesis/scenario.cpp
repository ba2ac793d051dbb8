#include "thesis/scenario.h"

#include <fmt/format.h>

#include <time.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <utility>

#include "gotai/core/error.h"
#include "gotai/core/parallel.h"

namespace gotai::experiments {

Setup setup_of(const Json& point, Setup s) {
  s.method = point.value("method", s.method);
  s.model = point.value("model", s.model);
  s.level = point.value("level", s.level);
  s.dt = point.value("dt", s.dt);
  if (point.contains("integrator"))
    s.explicit_euler = point["integrator"].get<std::string>() == "explicit-euler";
  return s;
}

model::Settings settings_of(const Setup& setup) {
  model::Settings settings;
  settings.gravity = Vec3(0.0, 0.0, -kGravity);
  settings.collision.model = model::parse_collision_model(setup.model);
  settings.collision.level = setup.level;
  settings.impulse.contacts = model::ContactTreatment::all;
  if (setup.method == "C" || setup.method == "A") {
    settings.impulse.method = model::ImpulseMethodName::constraint;
    settings.impulse.solver = model::SolverName::exact;
    if (setup.method == "A") {
      settings.impulse.contacts = model::ContactTreatment::apparent;
    } else if (setup.model == "surface") {
      if (setup.reduced) settings.impulse.contacts = model::ContactTreatment::reduced;
      if (setup.substepped) settings.impulse.solver = model::SolverName::substepped;
    }
  } else if (setup.method == "I") {
    settings.impulse.method = model::ImpulseMethodName::impulse_averaged;
  } else if (setup.method == "S") {
    settings.impulse.method = model::ImpulseMethodName::impulse;
  } else {
    throw InvalidArgument("method", setup.method, "must be C, A, I or S");
  }
  settings.time.step = setup.dt;
  settings.time.integrator =
      setup.explicit_euler ? model::Integrator::explicit_euler : model::Integrator::semi_implicit;
  return settings;
}

World world_with_floor(const Setup& setup) {
  World world(settings_of(setup));
  model::Material material;
  material.restitution = setup.restitution;
  material.friction = setup.friction;
  world.set_default_material(material);
  world.add_plane({});
  return world;
}

std::shared_ptr<const voxel::Shape> prepare(const geometry::GeneratorOptions& options, int finest,
                                            const Setup& setup) {
  return prepare(options.shape, geometry::generate(options), finest, setup);
}

std::shared_ptr<const voxel::Shape> prepare(const std::string& name, geometry::Mesh mesh,
                                            int finest, const Setup& setup) {
  voxel::ShapeOptions how;
  how.prepared_level = finest;
  how.surface_level = setup.model == "surface" ? setup.level : 0;
  static std::mutex mutex;
  static std::map<std::string, std::shared_ptr<const voxel::Shape>> known;
  const std::string key = voxel::content_hash(mesh, how).hex();
  const std::lock_guard lock(mutex);
  std::shared_ptr<const voxel::Shape>& shape = known[key];
  if (!shape)
    shape = std::make_shared<const voxel::Shape>(voxel::make_shape(name, std::move(mesh), how));
  return shape;
}

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

BodyId add_unit_body(World& world, ShapeId shape, const Vec3& x_W, const Quat& q_WB,
                     const Vec3& v_W, const Vec3& w_W) {
  BodyDescription body;
  body.shape = shape;
  body.mass = 1.0;
  body.com_position = x_W;
  body.X_WM.q = q_WB;
  body.velocity = v_W;
  body.angular_velocity = w_W;
  return world.add_body(body);
}

std::vector<double> scheme_heights(double z0, double z_touch, double v0, double e, double dt,
                                   double duration) {
  std::vector<double> heights;
  double z = z0;
  double v = v0;
  const long steps = std::lround(duration / dt);
  for (long k = 0; k < steps; ++k) {
    const double gap = z - z_touch;
    const double free = v - kGravity * dt;
    if (free * dt >= -gap)
      v = free;
    else if (gap > 0.0 && v >= -2.0 * kGravity * dt)
      v = -gap / dt;
    else
      v = -e * std::min(v, 0.0);
    z += v * dt;
    heights.push_back(z);
  }
  return heights;
}

double bouncing_height(double z0, double z_touch, double e, double t) {
  double drop = z0 - z_touch;
  double speed = std::sqrt(2.0 * kGravity * drop);
  double start = speed / kGravity;  // of the present arc, at touch
  if (t < start) return z0 - 0.5 * kGravity * t * t;
  for (;;) {
    speed *= e;
    const double duration = 2.0 * speed / kGravity;
    if (duration < 1e-9) return z_touch;
    if (t < start + duration) {
      const double s = t - start;
      return z_touch + speed * s - 0.5 * kGravity * s * s;
    }
    start += duration;
  }
}

double touching_height(const voxel::Shape& shape, const Quat& q_WB, const Setup& setup) {
  double lowest = 0.0;
  const Vec3& com = shape.mass.center_of_mass;
  if (setup.model == "spheres") {
    const double r = shape.pyramid.grid.voxel_radius(setup.level);
    for (const Vec3& center : shape.pyramid.voxel_centers(setup.level))
      lowest = std::min(lowest, (q_WB * (center - com)).z() - r);
  } else {
    for (const geometry::Triangle& triangle : shape.mesh.triangles)
      for (const std::uint32_t v : triangle)
        lowest = std::min(lowest, (q_WB * (shape.mesh.vertices[v] - com)).z());
  }
  return -lowest;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

namespace {

/// Method and model of every line of a plot or table, in order of appearance.
std::vector<Json> lines_of(const std::vector<Record>& records) {
  std::vector<Json> lines;
  for (const Record& r : records) {
    const Json line{{"method", r["method"]}, {"model", r["model"]}};
    if (std::find(lines.begin(), lines.end(), line) == lines.end()) lines.push_back(line);
  }
  return lines;
}

}  // namespace

Plot by_level(const std::vector<Record>& records, const std::string& metric, std::string figure,
              std::string title, std::string y_label, bool log_y) {
  Plot plot{std::move(figure), std::move(title), "level", std::move(y_label), false, log_y, {}};
  for (const Json& line : lines_of(records)) {
    Series series;
    series.label = label_of(line);
    series.dashed = line["model"] == "surface";
    for (const Record& r : select(records, line)) {
      series.x.push_back(r["level"]);
      series.y.push_back(r[metric]);
    }
    plot.series.push_back(series);
  }
  return plot;
}

Table level_table(const std::vector<Record>& records, const std::string& metric, std::string number,
                  std::string title) {
  std::vector<int> levels;
  for (const Record& r : records)
    if (std::find(levels.begin(), levels.end(), r["level"].get<int>()) == levels.end())
      levels.push_back(r["level"]);
  std::sort(levels.begin(), levels.end());
  Table table{std::move(number), std::move(title), {{"method", "model"}}};
  for (const int level : levels) table.rows[0].push_back(fmt::format("level {}", level));
  for (const Json& line : lines_of(records)) {
    std::vector<std::string> row{line["method"], line["model"]};
    for (const int level : levels) {
      Json match = line;
      match["level"] = level;
      const std::vector<Record> found = select(records, match);
      row.push_back(found.empty() ? "" : fmt::format("{:.4g}", found[0][metric].get<double>()));
    }
    table.rows.push_back(row);
  }
  return table;
}

void show_times(Outcome& outcome, const std::vector<Record>& records, const std::string& what,
                double duration, const std::string& total_table, const std::string& impulse_table) {
  const std::string axis = fmt::format("time for {:g} s [ms]", duration);
  outcome.plots.push_back(by_level(records, "total_ms", "", what + ": computing time", axis, true));
  outcome.plots.push_back(
      by_level(records, "impulse_ms", "", what + ": time for the impulses", axis, true));
  outcome.tables.push_back(
      level_table(records, "total_ms", total_table, what + ": computing time [ms]"));
  outcome.tables.push_back(
      level_table(records, "impulse_ms", impulse_table, what + ": time for the impulses [ms]"));
}

double rms(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
  return a.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(a.size()));
}

Totals::Totals(World& world) : lowest_energy_(world.energy().total()) {
  world.add_observer([this](const World&, const model::StepReport& report) {
    ++steps_;
    collision_s += report.collision_s;
    impulse_s += report.impulse_s;
    integration_s += report.integration_s;
    total_s += report.total_s();
    tests += report.tests;
    contacts_ += report.contacts;
    contacts_max_ = std::max<std::uint64_t>(contacts_max_, report.contacts);
    overlap_max_ = std::max(overlap_max_, report.max_overlap);
    const double energy = report.energy.total();
    energy_gain_ = std::max(energy_gain_, energy - lowest_energy_);
    lowest_energy_ = std::min(lowest_energy_, energy);
  });
}

void Totals::write(Json& record) const {
  record["steps"] = steps_;
  record["contacts_mean"] =
      steps_ > 0 ? static_cast<double>(contacts_) / static_cast<double>(steps_) : 0.0;
  record["contacts_max"] = contacts_max_;
  record["overlap_max"] = overlap_max_;
  record["energy_gain"] = energy_gain_;
}

void time_runs(const std::function<World()>& make_world, double duration, int repeats,
               Json& record) {
  const ThreadLimit one_thread(1);
  std::vector<double> total;
  std::vector<double> detection;
  std::vector<double> impulses;
  std::vector<double> integration;
  for (int k = 0; k < repeats; ++k) {
    World world = make_world();
    Totals totals(world);
    world.run_until(duration);
    total.push_back(1e3 * totals.total_s);
    detection.push_back(1e3 * totals.collision_s);
    impulses.push_back(1e3 * totals.impulse_s);
    integration.push_back(1e3 * totals.integration_s);
    totals.write(record);
  }
  record["total_ms"] = median(total);
  record["detection_ms"] = median(detection);
  record["impulse_ms"] = median(impulses);
  record["integration_ms"] = median(integration);
  record["impulse_least_ms"] = *std::min_element(impulses.begin(), impulses.end());
}

Verdict falls_with_level(std::string what, const std::vector<double>& errors, double floor,
                         double noise) {
  bool falls = !errors.empty() &&
               (errors.size() == 1 || errors.back() < errors.front() || errors.back() <= floor);
  std::string found;
  for (std::size_t k = 0; k < errors.size(); ++k) {
    if (k > 0) falls = falls && (errors[k] < errors[k - 1] + noise || errors[k] <= floor);
    found += fmt::format("{}{:.3g}", k > 0 ? ", " : "", errors[k]);
  }
  return {std::move(what), fmt::format("falls with the level, or <= {:.2g}", floor),
          std::move(found), falls};
}

std::string label_of(const Json& record) {
  return record.value("method", "") + ", " + record.value("model", "");
}

}  // namespace gotai::experiments
