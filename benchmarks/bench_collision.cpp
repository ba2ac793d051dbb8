/// What collision detection costs: the broad phase by number of bodies, the descent of one touching
/// pair by shape and level, and the whole search in a pile.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "gotai/collision/broad_phase.h"
#include "gotai/collision/find_contacts.h"
#include "gotai/collision/sphere_contacts.h"
#include "gotai/core/random.h"
#include "gotai/geometry/generate.h"
#include "gotai/geometry/load_mesh.h"
#include "gotai/voxel/shape.h"

namespace {

using namespace gotai;
using ShapePointer = std::shared_ptr<const voxel::Shape>;

/// A shape and relative poses in which two of it touch (mesh frame of a in that of b).
struct TouchingPairs {
  ShapePointer shape;
  std::vector<Pose> poses;
};

ShapePointer generate_shape(const std::string& name) {
  geometry::GeneratorOptions options;
  options.shape = name;
  options.size = 1.0;
  return std::make_shared<const voxel::Shape>(
      voxel::make_shape(name, geometry::generate(options), {.surface_level = 0}));
}

/// Random directions and rotations; the distance is that at which the spheres of the prepared level
/// begin to touch, less the two voxels that they stand off the surface.
TouchingPairs generate_pairs(const std::string& name) {
  TouchingPairs result{generate_shape(name), {}};
  const voxel::Pyramid& pyramid = result.shape->pyramid;
  const int level = pyramid.max_level();
  const collision::SphereTree tree = collision::make_sphere_tree(pyramid);
  collision::DescentScratch scratch;
  std::vector<collision::SphereOverlap> overlaps;
  collision::TestCounts tests{};
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Vec3 direction = random.unit_vector();
    const Quat rotation = random.rotation();
    double apart = 2.0;
    double touching = 0.0;
    while (apart - touching > 1e-4) {
      const double middle = 0.5 * (apart + touching);
      collision::descend(tree, tree, {middle * direction, rotation}, level, 0.0, scratch, overlaps,
                         tests);
      (overlaps.empty() ? apart : touching) = middle;
    }
    const double distance = touching - 2.0 * pyramid.grid.voxel_edge(level);
    result.poses.push_back({distance * direction, rotation});
  }
  return result;
}

/// The poses of bench/pairs whose kind is "touch".
TouchingPairs read_pairs(const std::filesystem::path& folder, const std::string& name) {
  geometry::Mesh mesh = geometry::load_mesh(folder / (name + ".obj")).mesh;
  TouchingPairs result{std::make_shared<const voxel::Shape>(
                           voxel::make_shape(name, std::move(mesh), {.surface_level = 0})),
                       {}};
  std::ifstream in(folder / fmt::format("{0}_{0}.csv", name));
  std::string line;
  while (std::getline(in, line)) {
    if (!line.starts_with("touch,")) continue;
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line.substr(6));
    Pose pose;
    fields >> pose.p.x() >> pose.p.y() >> pose.p.z() >> pose.q.w() >> pose.q.x() >> pose.q.y() >>
        pose.q.z();
    pose.q.normalize();
    result.poses.push_back(pose);
  }
  return result;
}

/// One touching pair after the other, contacts included.
void touching_pair(benchmark::State& state, const TouchingPairs& pairs, int level) {
  const collision::SphereTree tree = collision::make_sphere_tree(pairs.shape->pyramid);
  model::BodyState bodies;
  for (int i = 0; i < 2; ++i) {
    const model::BodyIndex body = model::append_body(bodies);
    bodies.geometry[body] = model::Geometry::shape;
    bodies.inverse_mass[body] = 1.0;
  }
  collision::SphereScratch scratch;
  collision::TestCounts tests{};
  model::ContactSet contacts;
  std::size_t next = 0;
  std::size_t found = 0;
  for (auto _ : state) {
    bodies.x_W[0] = pairs.poses[next].p;
    bodies.q_WB[0] = pairs.poses[next].q;
    next = (next + 1) % pairs.poses.size();
    contacts.clear();
    collision::append_sphere_contacts(bodies, {0, 1}, {&tree, 1}, level, 0.0, scratch, contacts,
                                      tests);
    found += contacts.size();
  }
  std::uint64_t total = 0;
  for (const std::uint64_t t : tests) total += t;
  state.counters["tests"] =
      benchmark::Counter(static_cast<double>(total), benchmark::Counter::kAvgIterations);
  state.counters["contacts"] =
      benchmark::Counter(static_cast<double>(found), benchmark::Counter::kAvgIterations);
}

/// A pile: a cubic lattice of bodies, shifted by up to a fifth of the spacing and turned at random.
model::BodyState make_pile(int count, double spacing, double radius) {
  model::BodyState bodies;
  Random random(2);
  int side = 1;
  while (side * side * side < count) ++side;
  for (int i = 0; i < count; ++i) {
    const model::BodyIndex body = model::append_body(bodies);
    const Vec3 cell(i % side, (i / side) % side, i / (side * side));
    bodies.x_W[body] = spacing * (cell + 0.2 * random.uniform() * random.unit_vector());
    bodies.q_WB[body] = random.rotation();
    bodies.geometry[body] = model::Geometry::shape;
    bodies.inverse_mass[body] = 1.0;
    bodies.bounding_radius[body] = radius;
  }
  return bodies;
}

void broad_phase(benchmark::State& state) {
  const model::BodyState bodies = make_pile(static_cast<int>(state.range(0)), 0.8, 0.5);
  collision::BroadPhase broad_phase;
  std::vector<collision::BodyPair> pairs;
  for (auto _ : state) broad_phase.find_pairs(bodies, bodies.bounding_radius, 0.0, pairs);
  state.counters["pairs"] = static_cast<double>(pairs.size());
}
BENCHMARK(broad_phase)->Arg(1000)->Arg(3000)->Arg(10000)->Unit(benchmark::kMillisecond);

/// The same with sizes over two orders of magnitude.
void broad_phase_mixed(benchmark::State& state) {
  model::BodyState bodies = make_pile(static_cast<int>(state.range(0)), 0.8, 0.5);
  Random random(3);
  for (double& radius : bodies.bounding_radius) {
    radius = 0.5 * std::pow(10.0, random.uniform(-2.0, 0.0));
  }
  collision::BroadPhase broad_phase;
  std::vector<collision::BodyPair> pairs;
  for (auto _ : state) broad_phase.find_pairs(bodies, bodies.bounding_radius, 0.0, pairs);
  state.counters["pairs"] = static_cast<double>(pairs.size());
}
BENCHMARK(broad_phase_mixed)->Arg(1000)->Arg(3000)->Arg(10000)->Unit(benchmark::kMillisecond);

void pile(benchmark::State& state, const ShapePointer& shape, int level) {
  const std::vector<ShapePointer> shapes{shape};
  const model::BodyState bodies = make_pile(500, 0.9, 0.0);
  model::CollisionSettings settings{model::CollisionModel::spheres, level};
  collision::CollisionCache cache;
  model::ContactSet contacts;
  collision::SearchStatistics statistics;
  for (auto _ : state) {
    statistics = collision::find_contacts(bodies, shapes, settings, 0.0, cache, contacts);
  }
  state.counters["candidates"] = statistics.candidate_pairs;
  state.counters["pairs"] = static_cast<double>(contacts.pairs.size());
  state.counters["contacts"] = static_cast<double>(contacts.size());
}

void add_pairs(const std::string& origin, const TouchingPairs& pairs) {
  for (const int level : {4, 5, 6, 7}) {
    benchmark::RegisterBenchmark(
        fmt::format("touching_pair/{}/{}/level{}", origin, pairs.shape->name, level).c_str(),
        [pairs, level](benchmark::State& state) { touching_pair(state, pairs, level); })
        ->Unit(benchmark::kMicrosecond);
  }
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  const std::filesystem::path measured = std::filesystem::path(GOTAI_SHARED_DIR) / "bench/pairs";
  for (const char* name : {"hexapod", "rock", "torus"}) {
    const TouchingPairs pairs = generate_pairs(name);
    add_pairs("generated", pairs);
    if (std::filesystem::exists(measured)) add_pairs("measured", read_pairs(measured, name));
    for (const int level : {4, 6}) {
      benchmark::RegisterBenchmark(
          fmt::format("pile500/{}/level{}", name, level).c_str(),
          [shape = pairs.shape, level](benchmark::State& state) { pile(state, shape, level); })
          ->Unit(benchmark::kMillisecond);
    }
  }
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
