// PILE(mesh, N): copies of a mesh fall into a container and come to rest. Prints the time of every
// phase and how far the true meshes overlap at the end, judged by exact distances to the triangles
// from points on the faces' edges.
//
//   bench_pile FOLDER MESH N [--seconds 5] [--level 6] [--contacts all|reduced] [--threads 1]
//
// FOLDER holds MESH.obj and MESH_N.csv: poses px,py,pz,qw,qx,qy,qz after a line
// "# bodies container_inner_edge_m container_height_m: N EDGE HEIGHT".
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <fstream>
#include <limits>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "gotai/core/error.h"
#include "gotai/core/parallel.h"
#include "gotai/geometry/load_mesh.h"
#include "gotai/voxel/signed_distance.h"
#include "gotai/world/world.h"

namespace {

using namespace gotai;

struct Options {
  std::string folder, mesh;
  int bodies = 0;
  double seconds = 5.0;
  int level = 6;
  int threads = 1;
  model::ContactTreatment contacts = model::ContactTreatment::reduced;
};

Options parse(int argc, char** argv) {
  if (argc < 4) {
    throw InvalidArgument("arguments", fmt::format("{}", argc - 1),
                          "bench_pile FOLDER MESH N [--seconds S] [--level L] [--contacts C] "
                          "[--threads T]");
  }
  Options o{argv[1], argv[2], std::stoi(argv[3])};
  for (int i = 4; i + 1 < argc; i += 2) {
    const std::string key = argv[i];
    const std::string value = argv[i + 1];
    if (key == "--seconds") o.seconds = std::stod(value);
    if (key == "--level") o.level = std::stoi(value);
    if (key == "--threads") o.threads = std::stoi(value);
    if (key == "--contacts") o.contacts = model::parse_contact_treatment(value);
  }
  return o;
}

struct Pile {
  Vec3 inner = Vec3::Zero();
  std::vector<Pose> poses;
};

Pile read_pile(const std::string& path) {
  std::ifstream in(path);
  std::string line;
  Pile pile;
  if (!std::getline(in, line) || line.find(':') == std::string::npos) {
    throw FileError(path, "does not start with the size of the container");
  }
  std::istringstream header(line.substr(line.find(':') + 1));
  double count = 0.0;
  header >> count >> pile.inner.x() >> pile.inner.z();
  pile.inner.y() = pile.inner.x();
  std::getline(in, line);  // names of the columns
  while (std::getline(in, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream row(line);
    Pose X;
    row >> X.p.x() >> X.p.y() >> X.p.z() >> X.q.w() >> X.q.x() >> X.q.y() >> X.q.z();
    X.q.normalize();
    pile.poses.push_back(X);
  }
  return pile;
}

// How near two surfaces are: from vertices and points along the edges of each to the triangles of
// the other.
class Judge {
 public:
  explicit Judge(const geometry::Mesh& mesh)
      : distance_(mesh), diagonal_(geometry::bounding_box(mesh).diagonal().norm()) {
    points_ = mesh.vertices;
    const double step = 0.01 * diagonal_;
    for (std::uint32_t t = 0; t < distance_.triangle_count(); ++t) {
      const auto& c = distance_.corners(t);
      for (int e = 0; e < 3; ++e) {
        const std::uint32_t other = distance_.neighbor(t, e);
        if (other < t || distance_.face_normal(t).isZero()) continue;
        const Vec3 a = distance_.vertex(c[static_cast<std::size_t>(e)]);
        const Vec3 b = distance_.vertex(c[static_cast<std::size_t>((e + 1) % 3)]);
        const int count = static_cast<int>((b - a).norm() / step);
        for (int k = 1; k < count; ++k) points_.push_back(a + (b - a) * k / count);
      }
    }
  }

  double diagonal() const { return diagonal_; }
  const std::vector<Vec3>& points() const { return points_; }

  // Signed gap of A's points in B [m]; infinite beyond the limit.
  double gap(const Pose& X_BA, double limit) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Vec3& x : points_) {
      const Vec3 x_B = X_BA * x;
      if (distance_box_.squaredExteriorDistance(x_B) > limit * limit) continue;
      least = std::min(least, distance_.query(x_B, limit).distance);
    }
    return least;
  }
  void set_box(const geometry::Mesh& mesh) { distance_box_ = geometry::bounding_box(mesh); }

 private:
  voxel::SignedDistance distance_;
  double diagonal_;
  Box3 distance_box_;
  std::vector<Vec3> points_;
};

struct Verdict {
  double mean = 0.0, p99 = 0.0, max = 0.0, gap3 = 0.0;  // fractions of the diagonal
  std::size_t touching = 0;
};

Verdict judge(const World& world, const Judge& body, const Pile& pile, double radius) {
  const auto& bodies = world.bodies();
  const double limit = 0.05 * body.diagonal();
  std::vector<std::vector<double>> gaps(bodies.size());
  std::vector<double> penetration;
  const auto add = [&](double gap) {
    if (gap < 1e-3 * body.diagonal()) {
      penetration.push_back(std::max(0.0, -gap) / body.diagonal());
    }
  };
  for (model::BodyIndex i = 0; i < bodies.size(); ++i) {
    if (!bodies.is_dynamic(i)) continue;
    const Pose X_i = bodies.mesh_pose(i);
    for (model::BodyIndex j = 0; j < i; ++j) {
      if (!bodies.is_dynamic(j)) continue;
      if ((bodies.x_W[i] - bodies.x_W[j]).norm() > 2.0 * radius + limit) continue;
      const Pose X_j = bodies.mesh_pose(j);
      const double gap =
          std::min(body.gap(X_j.inverse() * X_i, limit), body.gap(X_i.inverse() * X_j, limit));
      gaps[i].push_back(gap);
      gaps[j].push_back(gap);
      add(gap);
    }
    std::array<double, 5> faces;
    faces.fill(std::numeric_limits<double>::infinity());
    for (const Vec3& x : body.points()) {
      const Vec3 p = X_i * x;
      const std::array<double, 5> h = {p.z(), 0.5 * pile.inner.x() - p.x(),
                                       0.5 * pile.inner.x() + p.x(), 0.5 * pile.inner.y() - p.y(),
                                       0.5 * pile.inner.y() + p.y()};
      for (std::size_t f = 0; f < 5; ++f) faces[f] = std::min(faces[f], h[f]);
    }
    for (const double gap : faces) {
      gaps[i].push_back(gap);
      add(gap);
    }
  }
  Verdict v;
  v.touching = penetration.size();
  std::sort(penetration.begin(), penetration.end());
  for (const double p : penetration) v.mean += p / static_cast<double>(penetration.size());
  if (!penetration.empty()) {
    v.p99 = penetration[penetration.size() * 99 / 100];
    v.max = penetration.back();
  }
  std::vector<double> third;
  for (auto& g : gaps) {
    if (g.size() < 3) continue;
    std::sort(g.begin(), g.end());
    third.push_back(g[2] / body.diagonal());
  }
  std::sort(third.begin(), third.end());
  if (!third.empty()) v.gap3 = third[third.size() / 2];
  return v;
}

double rms_speed(const World& world) {
  double sum = 0.0;
  double count = 0.0;
  for (model::BodyIndex i = 0; i < world.bodies().size(); ++i) {
    if (!world.bodies().is_dynamic(i)) continue;
    sum += world.bodies().v_W[i].squaredNorm();
    count += 1.0;
  }
  return std::sqrt(sum / std::max(1.0, count));
}

// Processor time of this process: unlike wall-clock time it means something on a busy machine.
double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// Milliseconds per step, wall clock.
struct Times {
  double total = 0.0, collision = 0.0, impulse = 0.0, contacts = 0.0, pairs = 0.0;
  int steps = 0;

  void add(const model::StepReport& r) {
    total += 1e3 * r.total_s();
    collision += 1e3 * r.collision_s;
    impulse += 1e3 * r.impulse_s;
    contacts += r.contacts;
    pairs += static_cast<double>(r.pairs);
    ++steps;
  }
  void print(const char* name) const {
    const double n = std::max(1, steps);
    fmt::print("{:<12} ms/step {:8.3f}  collision {:8.3f}  impulse {:8.3f}  contacts {:8.0f}\n",
               name, total / n, collision / n, impulse / n, contacts / n);
  }
};

void run(const Options& o) {
  const ThreadLimit threads(o.threads);
  const geometry::Mesh mesh = geometry::load_mesh(o.folder + "/" + o.mesh + ".obj", {}).mesh;
  const Pile pile = read_pile(fmt::format("{}/{}_{}.csv", o.folder, o.mesh, o.bodies));
  model::Settings settings;
  settings.collision.model = model::CollisionModel::surface;
  settings.collision.level = o.level;
  settings.impulse.contacts = o.contacts;
  settings.time.step = 1.0 / 60.0;
  World world(settings);
  model::Material material;
  material.friction = 0.5;
  material.restitution = 0.2;
  world.set_default_material(material);
  const auto shape = world.add_shape(std::make_shared<const voxel::Shape>(
      voxel::make_shape(o.mesh, mesh, {.prepared_level = o.level, .surface_level = o.level})));
  world.add_container({.name = "container", .inner = pile.inner});
  for (const Pose& X : pile.poses) {
    BodyDescription body;
    body.shape = shape;
    body.X_WM = X;
    world.add_body(body);
  }
  const double initial = world.energy().total();
  Times all;
  Times rest;
  double cpu_at_rest = 0.0;
  const double cpu_start = cpu_seconds();
  double worst = 0.0;
  double highest = initial;
  while (!world.has_reached(o.seconds)) {
    const model::StepReport report = world.step();
    all.add(report);
    if (world.time() > o.seconds - 1.0) {
      if (rest.steps == 0) cpu_at_rest = cpu_seconds();
      rest.add(report);
    }
    worst = std::max(worst, 1e3 * report.total_s());
    highest = std::max(highest, report.energy.total());
    if (world.step_count() % 60 == 0) {
      fmt::print("  t {:.2f} ms {:.2f} contacts {} overlap {:.2e} rms {:.1e}\n", world.time(),
                 1e3 * report.total_s(), report.contacts, report.max_overlap, rms_speed(world));
      std::fflush(stdout);
    }
  }
  fmt::print("PILE({}, {}), level {}, contacts {}, {} threads\n", o.mesh, o.bodies, o.level,
             model::to_string(o.contacts), o.threads);
  all.print("run");
  rest.print("last second");
  const double cpu_end = cpu_seconds();
  fmt::print("processor ms/step {:.3f}, last second {:.3f} (all threads)\n",
             1e3 * (cpu_end - cpu_start) / std::max(1, all.steps),
             1e3 * (cpu_end - cpu_at_rest) / std::max(1, rest.steps - 1));
  Judge body(mesh);
  body.set_box(mesh);
  const Verdict v = judge(world, body, pile, world.shapes()[0]->bounding_radius);
  fmt::print("worst step   {:.3f} ms\n", worst);
  fmt::print("penetration  mean {:.4f} %  p99 {:.4f} %  max {:.4f} %  ({} touching)\n",
             100.0 * v.mean, 100.0 * v.p99, 100.0 * v.max, v.touching);
  fmt::print("gap3         {:.4f} %\n", 100.0 * v.gap3);
  fmt::print("rms speed    {:.2e} m/s\n", rms_speed(world));
  fmt::print("energy gain  {:.2e} of the initial energy\n",
             (highest - initial) / std::max(1e-300, std::abs(initial)));
  fmt::print("state hash   {}\n", world.state_hash().hex());
}

}  // namespace

int main(int argc, char** argv) {
  try {
    run(parse(argc, argv));
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
