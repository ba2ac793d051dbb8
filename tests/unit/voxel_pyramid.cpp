#include "gotai/voxel/pyramid.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <set>

#include "gotai/core/error.h"
#include "gotai/core/parallel.h"
#include "gotai/voxel/inside.h"
#include "support/golden.h"

namespace gotai::voxel {
namespace {

Vec3 vec3(const nlohmann::json& json) {
  return Vec3(json[0].get<double>(), json[1].get<double>(), json[2].get<double>());
}

geometry::Mesh golden_mesh(const nlohmann::json& json) {
  geometry::Mesh mesh;
  for (const auto& v : json.at("vertices")) mesh.vertices.push_back(vec3(v));
  mesh.tetrahedra = json.at("tets").get<std::vector<geometry::Tetrahedron>>();
  return mesh;
}

/// Linear indices ix + n (iy + n iz), ascending.
std::vector<std::uint32_t> linear(const std::vector<VoxelIndex>& voxels, int level) {
  const std::uint32_t n = 1U << static_cast<unsigned>(level - 1);
  std::vector<std::uint32_t> list;
  list.reserve(voxels.size());
  for (const VoxelIndex& v : voxels) list.push_back(v[0] + n * (v[1] + n * v[2]));
  std::sort(list.begin(), list.end());
  return list;
}

void expect_golden(const std::vector<VoxelIndex>& voxels, const nlohmann::json& level,
                   const std::string& name) {
  const std::vector<std::uint32_t> list = linear(voxels, level.at("level"));
  EXPECT_EQ(list.size(), level.at(name).get<std::size_t>()) << name;
  if (level.contains(name + "_list")) {
    EXPECT_EQ(list, level.at(name + "_list").get<std::vector<std::uint32_t>>()) << name;
  }
  std::string text;
  for (const std::uint32_t i : list) text += (text.empty() ? "" : ",") + std::to_string(i);
  EXPECT_EQ(test::sha256(text), level.at(name + "_sha256")) << name;
}

class GoldenVoxels : public testing::TestWithParam<std::string> {};

TEST_P(GoldenVoxels, AreExactlyEqual) {
  const nlohmann::json golden = test::golden("voxels.json").at("meshes").at(GetParam());
  const geometry::Mesh mesh = golden_mesh(golden);
  const VoxelGrid grid{vec3(golden.at("origin")), golden.at("L")};
  const int max_level = golden.at("max_level");
  const Pyramid pyramid = build_pyramid(grid, voxels_in_tetrahedra(mesh, grid, max_level));
  ASSERT_EQ(pyramid.max_level(), max_level);
  ASSERT_EQ(golden.at("levels").size(), static_cast<std::size_t>(max_level));
  for (const auto& level : golden.at("levels")) {
    const int h = level.at("level");
    SCOPED_TRACE(h);
    const VoxelSet inside = voxels_in_tetrahedra(mesh, grid, h);
    EXPECT_EQ(inside.side(), level.at("n").get<int>());
    EXPECT_EQ(grid.voxel_edge(h), level.at("edge").get<double>());
    EXPECT_DOUBLE_EQ(grid.voxel_radius(h), level.at("radius").get<double>());
    expect_golden(inside.morton_sorted(), level, "direct_in");
    expect_golden(inside.surface().morton_sorted(), level, "direct_surf6");
    expect_golden(pyramid.level(h).index, level, "pyramid_surf6");
  }
}

TEST_P(GoldenVoxels, GridIsTheSmallestCubeAroundTheBox) {
  const nlohmann::json golden = test::golden("voxels.json").at("meshes").at(GetParam());
  const VoxelGrid grid = grid_around(geometry::bounding_box(golden_mesh(golden)));
  EXPECT_DOUBLE_EQ(grid.edge, golden.at("L").get<double>());
  EXPECT_LT((grid.origin - vec3(golden.at("origin"))).norm(), 1e-15 * grid.edge);
}

INSTANTIATE_TEST_SUITE_P(Meshes, GoldenVoxels,
                         testing::Values("cube_rot", "lshape_rot", "hexapod_rot"),
                         [](const auto& param_info) { return param_info.param; });

/// The unit cube about the origin in Kuhn's six tetrahedra around the diagonal 0-7.
geometry::Mesh kuhn_cube() {
  geometry::Mesh mesh;
  const nlohmann::json golden = test::golden("voxels.json").at("tie_cases").at(0);
  for (const auto& v : golden.at("vertices")) mesh.vertices.push_back(vec3(v));
  std::array<std::uint32_t, 3> axes{1, 2, 4};
  do {
    mesh.tetrahedra.push_back({0, axes[0], axes[0] + axes[1], 7});
  } while (std::next_permutation(axes.begin(), axes.end()));
  return mesh;
}

TEST(VoxelTies, CentersOnSharedFacesAreInside) {
  const nlohmann::json golden = test::golden("voxels.json").at("tie_cases").at(0);
  const geometry::Mesh mesh = kuhn_cube();
  const VoxelGrid grid = grid_around(geometry::bounding_box(mesh));
  for (int h = 1; h <= 7; ++h) {
    const VoxelSet inside = voxels_in_tetrahedra(mesh, grid, h);
    const auto i = static_cast<std::size_t>(h) - 1;
    EXPECT_EQ(inside.count(), golden.at("expected_direct_in").at(i).get<std::uint64_t>());
    EXPECT_EQ(inside.surface().count(), golden.at("expected_surf6").at(i).get<std::uint64_t>());
  }
}

TEST(VoxelTies, DoNotDependOnRounding) {
  // A grid that is no multiple of powers of two: the centres on the tets' common faces are rounded,
  // but no centre inside the cube may be lost between them.
  geometry::Mesh mesh = kuhn_cube();
  for (Vec3& v : mesh.vertices) v = v * 0.7 + Vec3(0.1, 0.2, 0.3);
  const VoxelGrid grid = grid_around(geometry::bounding_box(mesh));
  for (int h = 1; h <= 7; ++h)
    EXPECT_EQ(voxels_in_tetrahedra(mesh, grid, h).count(), std::uint64_t{1} << (3 * (h - 1)));
}

TEST(Pyramid, ParentsExistWhereAnyChildDoesAndChildrenAreContiguous) {
  const nlohmann::json golden = test::golden("voxels.json").at("meshes").at("hexapod_rot");
  const geometry::Mesh mesh = golden_mesh(golden);
  const VoxelGrid grid = grid_around(geometry::bounding_box(mesh));
  const Pyramid pyramid = build_pyramid(grid, voxels_in_tetrahedra(mesh, grid, 6));
  EXPECT_EQ(pyramid.level(1).size(), 1U);
  for (int h = 1; h < 6; ++h) {
    const PyramidLevel& parents = pyramid.level(h);
    const PyramidLevel& children = pyramid.level(h + 1);
    ASSERT_EQ(parents.first_child.size(), parents.size() + 1);
    EXPECT_EQ(parents.first_child.front(), 0U);
    EXPECT_EQ(parents.first_child.back(), children.size());
    for (std::size_t i = 0; i < parents.size(); ++i) {
      ASSERT_LT(parents.first_child[i], parents.first_child[i + 1]);
      for (std::size_t c = parents.first_child[i]; c < parents.first_child[i + 1]; ++c)
        for (std::size_t k = 0; k < 3; ++k)
          EXPECT_EQ(children.index[c][k] / 2, parents.index[i][k]);
    }
    EXPECT_EQ(std::set<VoxelIndex>(parents.index.begin(), parents.index.end()).size(),
              parents.size());
    EXPECT_EQ(pyramid.voxel_center(h, 0), grid.voxel_center(h, parents.index.at(0)));
  }
  EXPECT_TRUE(pyramid.level(6).first_child.empty());
}

TEST(Pyramid, IsTheSameForEveryNumberOfThreads) {
  const geometry::Mesh mesh =
      golden_mesh(test::golden("voxels.json").at("meshes").at("lshape_rot"));
  const VoxelGrid grid = grid_around(geometry::bounding_box(mesh));
  const auto count = [&](int threads) {
    const ThreadLimit limit(threads);
    return voxels_in_tetrahedra(mesh, grid, 8);
  };
  EXPECT_EQ(count(1), count(2));
}

TEST(Pyramid, RefusesBadBoxes) {
  EXPECT_THROW(grid_around(Box3()), InvalidArgument);
  EXPECT_THROW(grid_around(Box3(Vec3(1, 1, 1), Vec3(1, 1, 1))), InvalidArgument);
  EXPECT_THROW(grid_around(Box3(Vec3(0, 0, 0), Vec3(1e40, 1, 1))), InvalidArgument);
  EXPECT_THROW(grid_around(Box3(Vec3(1e12, 0, 0), Vec3(1e12 + 1, 1, 1))), InvalidArgument);
  EXPECT_THROW(VoxelSet(0), InvalidArgument);
  EXPECT_THROW(VoxelSet(kMaxLevel + 1), InvalidArgument);
  EXPECT_THROW(build_pyramid({Vec3::Zero(), 1.0}, VoxelSet(4)), InvalidArgument);
}

}  // namespace
}  // namespace gotai::voxel
