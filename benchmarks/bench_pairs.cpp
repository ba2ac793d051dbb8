// Pair poses with exact answers: how far gap and normal of the deepest contact are off, by level,
// with the orders of convergence, and the processor time of a pair (both directions).
//
//   bench_pairs FOLDER [--margin 0.01] [--repeat 5] [--level 6] [--mesh hexapod]
// --mesh leaves out the pairs of others.
// FOLDER holds the meshes and A_B.csv: kind,px,py,pz,qw,qx,qy,qz,gap,cx,cy,cz,nx,ny,nz with the
// pose of A's mesh frame in B's, lengths in fractions of the largest extent.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <limits>
#include <memory>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "gotai/collision/surface_contacts.h"
#include "gotai/core/error.h"
#include "gotai/geometry/load_mesh.h"

namespace {

using namespace gotai;

struct PairPose {
  bool touches = false;
  Pose X_BA;
  double gap = 0.0;
  Vec3 normal_B = Vec3::Zero();  // of B, outward
};

std::vector<PairPose> read_poses(const std::string& path) {
  std::ifstream in(path);
  std::string line;
  if (!std::getline(in, line)) throw FileError(path, "cannot be read");
  std::vector<PairPose> poses;
  while (std::getline(in, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream row(line);
    PairPose p;
    std::string kind;
    Vec3 point;
    row >> kind >> p.X_BA.p.x() >> p.X_BA.p.y() >> p.X_BA.p.z() >> p.X_BA.q.w() >> p.X_BA.q.x() >>
        p.X_BA.q.y() >> p.X_BA.q.z() >> p.gap >> point.x() >> point.y() >> point.z() >>
        p.normal_B.x() >> p.normal_B.y() >> p.normal_B.z();
    p.touches = kind == "touch";
    p.X_BA.q.normalize();
    poses.push_back(p);
  }
  return poses;
}

using ShapePointer = std::shared_ptr<const voxel::Shape>;

ShapePointer prepare(const std::string& folder, const std::string& name, int level) {
  return std::make_shared<const voxel::Shape>(
      voxel::make_shape(name, geometry::load_mesh(folder + "/" + name + ".obj", {}).mesh,
                        {.prepared_level = 5, .surface_level = level}));
}

// Two bodies, B at the origin.
class Pair {
 public:
  Pair(const ShapePointer& a, const ShapePointer& b) : shapes_{a, b} {
    for (std::uint32_t i = 0; i < 2; ++i) {
      const auto body = model::append_body(bodies_);
      bodies_.geometry[body] = model::Geometry::shape;
      bodies_.kind[body] = model::BodyKind::dynamic;
      bodies_.shape[body] = i;
      bodies_.p_MB[body] = shapes_[i]->mass.center_of_mass;
      bodies_.bounding_radius[body] = shapes_[i]->bounding_radius;
      exact_.push_back(std::make_unique<const collision::ExactSurface>(*shapes_[i]));
    }
    place(1, {});
  }
  const model::ContactSet& find(const Pose& X_BA, double margin,
                                const collision::SearchOptions& options) {
    place(0, X_BA);
    contacts_.clear();
    append_surface_contacts(bodies_, {0, 1}, shapes_, exact_, margin, options, scratch_, contacts_);
    return contacts_;
  }

 private:
  void place(model::BodyIndex i, const Pose& X) {
    bodies_.q_WB[i] = X.q;
    bodies_.x_W[i] = X * bodies_.p_MB[i];
  }

  std::vector<ShapePointer> shapes_;
  std::vector<std::unique_ptr<const collision::ExactSurface>> exact_;
  model::BodyState bodies_;
  model::ContactSet contacts_;
  collision::SurfaceScratch scratch_;
};

struct Figures {
  double gap_rms = 0.0, gap_mean = 0.0, gap_max = 0.0;  // fractions of the extent
  double normal_median = 0.0;                           // [degrees]
  double us = 0.0;                                      // processor time per pair
  int count = 0;
};

Figures measure(Pair& pair, const std::vector<PairPose>& poses, bool touching, double margin,
                int repeat, model::ContactTreatment treatment) {
  Figures f;
  std::vector<double> angles;
  for (const PairPose& p : poses) {
    if (p.touches != touching) continue;
    const model::ContactSet& contacts = pair.find(p.X_BA, 0.1, {treatment, 0.0, {}});
    std::size_t deepest = 0;
    for (std::size_t c = 1; c < contacts.size(); ++c) {
      if (contacts.gap[c] < contacts.gap[deepest]) deepest = c;
    }
    if (contacts.size() == 0) continue;
    const double error = contacts.gap[deepest] - p.gap;
    f.gap_rms += error * error;
    f.gap_mean += error;
    f.gap_max = std::max(f.gap_max, std::abs(error));
    const double cosine = std::clamp(contacts.normal_W[deepest].dot(p.normal_B), -1.0, 1.0);
    angles.push_back(std::acos(cosine) * 180.0 / std::numbers::pi);
    ++f.count;
  }
  if (f.count == 0) return f;
  f.gap_rms = std::sqrt(f.gap_rms / f.count);
  f.gap_mean /= f.count;
  std::sort(angles.begin(), angles.end());
  f.normal_median = angles[angles.size() / 2];
  f.us = std::numeric_limits<double>::infinity();
  const collision::SearchOptions reduced{model::ContactTreatment::reduced, 0.0, {}};
  for (int k = 0; k < repeat; ++k) {
    const std::clock_t start = std::clock();
    int pairs = 0;
    for (const PairPose& p : poses) {
      if (p.touches != touching) continue;
      pair.find(p.X_BA, margin, reduced);
      ++pairs;
    }
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    f.us = std::min(f.us, 1e6 * seconds / pairs);
  }
  return f;
}

void run(const std::string& folder, double margin, int repeat, const std::vector<int>& levels,
         const std::string& mesh) {
  const std::array<std::array<const char*, 2>, 4> pairs = {
      {{"hexapod", "hexapod"}, {"hexapod", "rock"}, {"rock", "rock"}, {"torus", "torus"}}};
  fmt::print("gap errors in % of the extent; time with reduced contacts up to a gap of {}\n",
             margin);
  for (const auto& [a, b] : pairs) {
    if (!mesh.empty() && (a != mesh || b != mesh)) continue;
    const std::vector<PairPose> poses = read_poses(fmt::format("{}/{}_{}.csv", folder, a, b));
    std::array<Figures, 2> previous;
    for (const int level : levels) {
      const ShapePointer shape_a = prepare(folder, a, level);
      const ShapePointer shape_b = std::string(a) == b ? shape_a : prepare(folder, b, level);
      Pair pair(shape_a, shape_b);
      for (const bool touching : {true, false}) {
        const Figures raw = measure(pair, poses, touching, margin, 1, model::ContactTreatment::all);
        const Figures f =
            measure(pair, poses, touching, margin, repeat, model::ContactTreatment::reduced);
        const Figures& before = previous[touching ? 0 : 1];
        fmt::print(
            "{:>7}-{:<7} L{} {:5}  gap rms {:.4f} (field alone {:.4f}) mean {:+.4f} max {:.3f}  "
            "normal median {:5.2f} deg  {:6.2f} us  ({} poses)",
            a, b, level, touching ? "touch" : "near", 100.0 * f.gap_rms, 100.0 * raw.gap_rms,
            100.0 * f.gap_mean, 100.0 * f.gap_max, f.normal_median, f.us, f.count);
        if (before.count > 0) {
          fmt::print("  orders: gap {:.2f} normal {:.2f}", std::log2(before.gap_rms / f.gap_rms),
                     std::log2(before.normal_median / std::max(1e-9, f.normal_median)));
        }
        fmt::print("\n");
        std::fflush(stdout);
        previous[touching ? 0 : 1] = f;
      }
      if (level == 6) {
        fmt::print("        memory: {} {} KB, {} {} KB\n", a, shape_a->surface.bytes() / 1024, b,
                   shape_b->surface.bytes() / 1024);
      }
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc < 2)
      throw InvalidArgument(
          "arguments", "none",
          "bench_pairs FOLDER [--margin M] [--repeat R] [--level L] [--mesh NAME]");
    double margin = 0.01;
    int repeat = 5;
    std::vector<int> levels = {5, 6, 7};
    std::string mesh;
    for (int i = 2; i + 1 < argc; i += 2) {
      if (std::string(argv[i]) == "--margin") margin = std::stod(argv[i + 1]);
      if (std::string(argv[i]) == "--repeat") repeat = std::stoi(argv[i + 1]);
      if (std::string(argv[i]) == "--mesh") mesh = argv[i + 1];
      if (std::string(argv[i]) == "--level") levels = {std::stoi(argv[i + 1])};
    }
    run(argv[1], margin, repeat, levels, mesh);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
