#include "gotai/voxel/winding_tree.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "gotai/core/parallel.h"
#include "gotai/core/random.h"
#include "gotai/geometry/generate.h"
#include "gotai/geometry/load_mesh.h"
#include "gotai/voxel/inside.h"
#include "gotai/voxel/inside_soup.h"
#include "gotai/voxel/orient_soup.h"
#include "support/golden.h"
#include "support/mesh_text.h"

namespace gotai::voxel {
namespace {

using geometry::Mesh;
using geometry::Triangle;

TEST(WindingTree, IsExactForClosedSurfacesAndFastIsNearExact) {
  Random random(3);
  for (const char* shape : {"rock", "torus", "hexapod"}) {
    const Mesh mesh = test::generated_surface(shape, shape == std::string("rock") ? 5 : 0);
    const WindingTree tree(mesh);
    for (int i = 0; i < 300; ++i) {
      const Vec3 x(random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5));
      const double exact = tree.exact_winding_number(x);
      EXPECT_NEAR(exact, std::round(exact), 1e-9) << shape;
      EXPECT_NEAR(tree.winding_number(x), exact, 0.02) << shape;
    }
  }
}

TEST(WindingTree, HalvesAcrossASheet) {
  Mesh sheet;
  sheet.vertices = {Vec3(-1, -1, 0), Vec3(1, -1, 0), Vec3(1, 1, 0), Vec3(-1, 1, 0)};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  const WindingTree tree(sheet);
  EXPECT_NEAR(tree.winding_number(Vec3(0.1, 0.2, 1e-9)), -0.5, 1e-6);
  EXPECT_NEAR(tree.winding_number(Vec3(0.1, 0.2, -1e-9)), 0.5, 1e-6);
  // A cube's face seen from its centre.
  EXPECT_NEAR(tree.winding_number(Vec3(0, 0, -1)), 1.0 / 6.0, 1e-12);
  EXPECT_EQ(WindingTree(Mesh()).winding_number(Vec3(1, 2, 3)), 0.0);
}

TEST(WindingTree, CountsWhatARayMeets) {
  const WindingTree tree(test::generated_surface("torus"));
  EXPECT_EQ(tree.count_hits(Vec3(-3.0, 0.013, 0.007), Vec3(1, 0, 0), 0xffffffff), 4);
  EXPECT_EQ(tree.count_hits(Vec3(0.0, 0.013, 0.007), Vec3(1, 0, 0), 0xffffffff), 2);
  EXPECT_EQ(tree.count_hits(Vec3(0.0, 0.013, 0.007), Vec3(0, 0, 1), 0xffffffff), 0);
}

/// Seeded damage.
struct Damage {
  double removed = 0.0;  ///< fraction of faces
  double flipped = 0.0;
  double doubled = 0.0;  ///< fraction of faces that are there twice, half of the copies flipped
  int holes = 0;         ///< connected holes, each about 1/500 of the faces
};

Mesh damage(const Mesh& mesh, const Damage& kind, std::uint64_t seed) {
  Random random(seed);
  Mesh result;
  result.vertices = mesh.vertices;
  std::vector<Vec3> hole_centers;
  for (int h = 0; h < kind.holes; ++h) {
    const Triangle& t = mesh.triangles[random.next_u32() % mesh.triangles.size()];
    hole_centers.push_back(mesh.vertices[t[0]]);
  }
  double area = 0.0;
  for (const Triangle& t : mesh.triangles)
    area += 0.5 * (mesh.vertices[t[1]] - mesh.vertices[t[0]])
                      .cross(mesh.vertices[t[2]] - mesh.vertices[t[0]])
                      .norm();
  const double hole_radius = std::sqrt(area / 500.0 / std::numbers::pi);
  for (Triangle t : mesh.triangles) {
    const Vec3 center = (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.0;
    if (std::any_of(hole_centers.begin(), hole_centers.end(),
                    [&](const Vec3& h) { return (h - center).norm() < hole_radius; }))
      continue;
    if (random.uniform() < kind.removed) continue;
    if (random.uniform() < kind.flipped) std::swap(t[0], t[1]);
    result.triangles.push_back(t);
    if (random.uniform() < kind.doubled) {
      if (random.uniform() < 0.5) std::swap(t[1], t[2]);
      result.triangles.push_back({t[1], t[2], t[0]});
    }
  }
  return result;
}

/// Voxels that are in one set only, per voxel of the second.
double difference_share(const VoxelSet& a, const VoxelSet& b) {
  VoxelSet both = a;
  both.insert(b);
  return static_cast<double>(2 * both.count() - a.count() - b.count()) /
         static_cast<double>(b.count());
}

VoxelSet robust_voxels(const Mesh& mesh, const VoxelGrid& grid, int level) {
  return voxels_by_winding(WindingTree(orient_soup(mesh).mesh), grid, level);
}

/// The meshes that damage is tried on: generated ones, and those of the assets that are there.
std::vector<std::pair<std::string, Mesh>> clean_meshes() {
  std::vector<std::pair<std::string, Mesh>> meshes{{"rock", test::generated_surface("rock", 4)},
                                                   {"torus", test::generated_surface("torus", 8)}};
  for (const char* file :
       {"bunny.off", "spot.obj", "3holes.off", "cheburashka.off", "screw.stl", "fandisk.obj"}) {
    const auto path = test::shared_dir() / "assets" / "meshes" / file;
    if (!std::filesystem::exists(path)) continue;
    Mesh mesh;
    try {
      mesh = geometry::load_mesh(path).mesh;
    } catch (const std::exception&) {
      continue;
    }
    meshes.emplace_back(file, std::move(mesh));
  }
  return meshes;
}

TEST(Soup, DamagedMeshesKeepTheirVoxels) {
  const std::vector<std::pair<std::string, Damage>> kinds{
      {"5 % removed", {.removed = 0.05}},
      {"10 % flipped", {.flipped = 0.1}},
      {"half flipped", {.flipped = 0.5}},
      {"doubled", {.doubled = 0.5}},
      {"holes", {.holes = 5}},
      {"all", {.removed = 0.05, .flipped = 0.1, .doubled = 0.2, .holes = 5}}};
  for (const auto& [name, mesh] : clean_meshes()) {
    ASSERT_TRUE(has_closed_surface(mesh)) << name;
    const VoxelGrid grid = grid_around(geometry::bounding_box(mesh));
    const VoxelSet clean = voxels_in_closed_surface(mesh, grid, 6);
    for (const auto& [what, kind] : kinds)
      EXPECT_LT(difference_share(robust_voxels(damage(mesh, kind, 1), grid, 6), clean), 0.01)
          << name << ", " << what;
  }
}

TEST(Soup, BlocksFarFromTheSurfaceAreDecidedLikeTheirVoxels) {
  const Mesh mesh = damage(test::generated_surface("rock", 4), {.removed = 0.05, .holes = 8}, 3);
  const VoxelGrid grid = grid_around(geometry::bounding_box(mesh));
  const WindingTree tree(mesh);
  const VoxelSet voxels = voxels_by_winding(tree, grid, 6);
  VoxelSet plain(6);
  for (std::uint16_t iz = 0; iz < 32; ++iz)
    for (std::uint16_t iy = 0; iy < 32; ++iy)
      for (std::uint16_t ix = 0; ix < 32; ++ix)
        if (tree.winding_number(grid.voxel_center(6, {ix, iy, iz})) > 0.5) plain.insert(ix, iy, iz);
  EXPECT_EQ(voxels, plain);
}

TEST(Soup, OrientationIsTheSameForEveryNumberOfThreads) {
  const Mesh mesh =
      damage(test::generated_surface("torus", 8), {.removed = 0.2, .flipped = 0.3}, 4);
  const auto oriented = [&](int threads) {
    const ThreadLimit limit(threads);
    return orient_soup(mesh).mesh.triangles;
  };
  EXPECT_EQ(oriented(1), oriented(2));
}

TEST(Soup, EnclosureTellsSolidsFromSheets) {
  const auto measure = [](const Mesh& mesh) { return enclosure(mesh, WindingTree(mesh)); };
  const Mesh ball = test::generated_surface("sphere", 12);
  EXPECT_GT(measure(ball), 0.97);
  Mesh half = ball;
  std::erase_if(half.triangles, [&](const Triangle& t) {
    return ball.vertices[t[0]].z() + ball.vertices[t[1]].z() + ball.vertices[t[2]].z() > 0.0;
  });
  EXPECT_NEAR(measure(half), 0.62, 0.05);
  EXPECT_NEAR(missing_share(half), 0.5, 0.05);
  EXPECT_LT(missing_share(ball), 1e-12);
  Mesh two = ball;  // one inside the other
  for (const Triangle& t : ball.triangles) {
    const auto n = static_cast<std::uint32_t>(ball.vertices.size());
    two.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
  }
  for (const Vec3& v : ball.vertices) two.vertices.push_back(0.5 * v);
  EXPECT_GT(measure(two), 0.97);
}

}  // namespace
}  // namespace gotai::voxel
