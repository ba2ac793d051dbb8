/// How long it takes to prepare shapes. `bench_voxel [MESH_FOLDER]` adds the surface meshes of a
/// folder to the generated rocks.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "gotai/geometry/generate.h"
#include "gotai/voxel/inside.h"
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
  benchmark::RunSpecifiedBenchmarks();
}
