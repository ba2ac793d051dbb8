// The nearest triangle, found eight at a time, against the search in double precision.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <vector>

#include "gotai/collision/exact_surface.h"
#include "gotai/core/random.h"
#include "gotai/geometry/generate.h"
#include "gotai/geometry/load_mesh.h"

namespace gotai::collision {
namespace {

class Exact : public testing::TestWithParam<std::string> {
 protected:
  static voxel::Shape make() {
    geometry::GeneratorOptions options;
    options.shape = GetParam();
    voxel::ShapeOptions how;
    how.prepared_level = 4;
    how.surface_level = 4;
    return voxel::make_shape(GetParam(), geometry::generate(options), how);
  }
};

TEST_P(Exact, NearestPointIsThatOfTheSearchInDoublePrecision) {
  const voxel::Shape shape = make();
  const ExactSurface exact(shape);
  const voxel::SignedDistance surface(shape.mesh);
  Random random(31);
  std::size_t beyond = 0;
  for (int k = 0; k < 2000; ++k) {
    const Vec3 x = random.uniform(0.0, 0.9) * random.unit_vector();
    const double limit = random.uniform(0.02, 0.5);
    const voxel::ClosestPoint slow = surface.query(x);
    const voxel::ClosestPoint fast = exact.nearest(x, limit);
    if (std::abs(slow.distance) > limit + 1e-5) {
      EXPECT_TRUE(std::isinf(fast.distance));
      ++beyond;
    } else if (std::abs(slow.distance) < limit - 1e-5) {
      ASSERT_NEAR(fast.distance, slow.distance, 1e-6);
      if (fast.triangle != slow.triangle) continue;
      ASSERT_EQ(fast.point, slow.point);
      ASSERT_EQ(fast.pseudonormal, slow.pseudonormal);
      ASSERT_EQ(exact.surface.face_normal(fast.triangle), surface.face_normal(slow.triangle));
    }
  }
  EXPECT_GT(beyond, 100U);
  EXPECT_LT(beyond, 1900U);
}

TEST_P(Exact, NearestTriangleIsTheSameOnEveryKernel) {
  for (const Kernel kernel : {Kernel::avx2, Kernel::avx512}) {
    if (!is_available(kernel)) continue;
    const voxel::Shape shape = make();
    const ExactSurface exact(shape);
    Random random(32);
    for (int k = 0; k < 2000; ++k) {
      const Eigen::Vector3f x = (random.uniform(0.0, 0.9) * random.unit_vector()).cast<float>();
      const auto limit = static_cast<float>(random.uniform(0.0, 0.5));
      const std::array<float, 3> p = {x.x(), x.y(), x.z()};
      ASSERT_EQ(nearest_triangle(exact.tree, p, limit, Kernel::portable),
                nearest_triangle(exact.tree, p, limit, kernel));
    }
  }
}

TEST_P(Exact, OfEquallyNearTrianglesTheFirstIsFoundWhateverTheLimit) {
  const voxel::Shape shape = make();
  const ExactSurface exact(shape);
  Random random(33);
  for (int k = 0; k < 2000; ++k) {
    // Over a vertex all triangles around it are equally far.
    const auto i = static_cast<std::size_t>(k) % shape.mesh.triangles.size();
    const Vec3 x = shape.mesh.vertices[shape.mesh.triangles[i][0]] +
                   random.uniform(0.0, 0.02) * random.unit_vector();
    const Eigen::Vector3f f = (x - exact.tree.center).cast<float>();
    const std::array<float, 3> p = {f.x(), f.y(), f.z()};
    const std::uint32_t near = nearest_triangle(exact.tree, p, 0.03F);
    ASSERT_LT(near, shape.mesh.triangles.size());
    for (const float limit : {0.3F, 3.0F, 1e30F, std::numeric_limits<float>::infinity()}) {
      ASSERT_EQ(nearest_triangle(exact.tree, p, limit), near) << limit;
    }
  }
}

// All that one shape of many bodies takes of memory.
TEST(Memory, OfAHexapodAndOfWhatAWorldPreparesOfItIsAtMost400KB) {
  std::vector<geometry::Mesh> meshes = {geometry::generate({.shape = "hexapod"})};
  const std::filesystem::path file = std::filesystem::path(GOTAI_SHARED_DIR) / "bench/hexapod.obj";
  if (std::filesystem::exists(file)) meshes.push_back(geometry::load_mesh(file).mesh);
  for (geometry::Mesh& mesh : meshes) {
    const voxel::Shape shape =
        voxel::make_shape("hexapod", std::move(mesh), {.prepared_level = 6, .surface_level = 6});
    const ExactSurface exact(shape);
    EXPECT_LE(shape.bytes() + exact.bytes(), 400U * 1024U)
        << shape.bytes() << " + " << exact.bytes() << ", " << shape.mesh.triangles.size()
        << " triangles";
    // Nothing is forgotten: more than what the largest parts take.
    EXPECT_GT(shape.bytes(), shape.surface.field.values.size() + sizeof(voxel::Shape) +
                                 shape.mesh.triangles.size() * sizeof(geometry::Triangle));
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, Exact, testing::Values("hexapod", "rock", "torus", "cube"));

}  // namespace
}  // namespace gotai::collision
