/// How long it takes to prepare shapes. `bench_voxel [MESH_FOLDER]` adds the surface meshes of a
/// folder to the generated rocks.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "gotai/core/error.h"
#include "gotai/core/parallel.h"
#include "gotai/core/random.h"
#include "gotai/geometry/generate.h"
#include "gotai/geometry/load_mesh.h"
#include "gotai/voxel/inside.h"
#include "gotai/voxel/inside_soup.h"
#include "gotai/voxel/orient_soup.h"
#include "gotai/voxel/shape.h"

namespace {

using namespace gotai;

geometry::Mesh rock(int subdivisions) {
  geometry::GeneratorOptions options;
  options.shape = "rock";
  options.subdivisions = subdivisions;
  geometry::Mesh mesh = geometry::generate(options);
  mesh.tetrahedra.clear();
  return mesh;
}

/// Level pyramid of a surface mesh, from the in-out test to the children's offsets.
void prepare_pyramid(benchmark::State& state, const geometry::Mesh& mesh, int level) {
  std::size_t voxels = 0;
  for (auto _ : state) {
    const voxel::VoxelGrid grid = voxel::grid_around(geometry::bounding_box(mesh));
    const voxel::Pyramid pyramid =
        voxel::build_pyramid(grid, voxel::voxels_in_closed_surface(mesh, grid, level));
    voxels = pyramid.level(level).size();
  }
  state.counters["triangles"] = static_cast<double>(mesh.triangles.size());
  state.counters["voxels"] = static_cast<double>(voxels);
}

/// The same of a surface that is not closed: orientation, winding numbers, voxels. One thread.
void prepare_soup(benchmark::State& state, const geometry::Mesh& mesh, int level) {
  const ThreadLimit one_core(1);
  std::size_t voxels = 0;
  for (auto _ : state) {
    const voxel::VoxelGrid grid = voxel::grid_around(geometry::bounding_box(mesh));
    const voxel::WindingTree tree(voxel::orient_soup(mesh).mesh);
    voxels =
        voxel::build_pyramid(grid, voxel::voxels_by_winding(tree, grid, level)).level(level).size();
  }
  state.counters["triangles"] = static_cast<double>(mesh.triangles.size());
  state.counters["voxels"] = static_cast<double>(voxels);
}

/// The whole shape, with pyramid and surface model of that level. One thread.
void prepare_shape(benchmark::State& state, const geometry::Mesh& mesh, int level) {
  const ThreadLimit one_core(1);
  std::size_t samples = 0;
  for (auto _ : state) {
    const voxel::Shape shape =
        voxel::make_shape("shape", mesh, {.prepared_level = level, .surface_level = level});
    samples = shape.surface.tree.size();
  }
  state.counters["triangles"] = static_cast<double>(mesh.triangles.size());
  state.counters["samples"] = static_cast<double>(samples);
}

/// A twentieth of the triangles missing, a tenth turned round.
geometry::Mesh damaged(geometry::Mesh mesh) {
  Random random(1);
  std::erase_if(mesh.triangles, [&](const auto&) { return random.uniform() < 0.05; });
  for (geometry::Triangle& t : mesh.triangles)
    if (random.uniform() < 0.1) std::swap(t[0], t[1]);
  return mesh;
}

/// The surface meshes of a folder; files that are none are passed over.
void add_folder(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const auto& file : files) {
    geometry::Mesh mesh;
    try {
      mesh = geometry::load_mesh(file).mesh;
    } catch (const Error& error) {
      fmt::print("left out: {}\n", error.what());
      continue;
    }
    if (mesh.has_tetrahedra() || !voxel::has_closed_surface(mesh)) continue;
    benchmark::RegisterBenchmark(
        fmt::format("pyramid/{}/level6", file.filename().string()).c_str(),
        [mesh](benchmark::State& state) { prepare_pyramid(state, mesh, 6); })
        ->Unit(benchmark::kMillisecond);
    benchmark::RegisterBenchmark(fmt::format("shape/{}/level6", file.filename().string()).c_str(),
                                 [mesh](benchmark::State& state) { prepare_shape(state, mesh, 6); })
        ->Unit(benchmark::kMillisecond);
  }
}

void add_soups() {
  for (const int level : {6, 7})
    benchmark::RegisterBenchmark(fmt::format("soup/rock81920/level{}", level).c_str(),
                                 [mesh = damaged(rock(6)), level](benchmark::State& state) {
                                   prepare_soup(state, mesh, level);
                                 })
        ->Unit(benchmark::kMillisecond);
}

void add_rocks() {
  for (const int subdivisions : {4, 6, 7})
    for (const int level : {6, 7, 9})
      benchmark::RegisterBenchmark(
          fmt::format("pyramid/rock{}/level{}", 20 << (2 * subdivisions), level).c_str(),
          [mesh = rock(subdivisions), level](benchmark::State& state) {
            prepare_pyramid(state, mesh, level);
          })
          ->Unit(benchmark::kMillisecond);
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  add_rocks();
  add_soups();
  if (argc > 1) add_folder(argv[1]);
  benchmark::RunSpecifiedBenchmarks();
}
