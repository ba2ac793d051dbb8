#include "gotai/voxel/pyramid2.h"

#include <gmock/gmock.h>

#include "gotai/core/error.h"
#include "gotai/geometry/generate.h"

namespace gotai::voxel {
namespace {

geometry::Mesh2 plane(const std::string& shape) {
  geometry::GeneratorOptions options;
  options.shape = shape;
  return geometry::generate_plane(options);
}

TEST(Pyramid2, SquareFillsItsGridAndKeepsItsBorder) {
  const geometry::Mesh2 square = plane("square");
  const Pyramid2 pyramid = make_pyramid2(square, 5);
  EXPECT_EQ(squares_inside(square, pyramid.grid, 5).size(), 256U);
  EXPECT_EQ(pyramid.level(5).size(), 60U);
  EXPECT_EQ(pyramid.level(4).size(), 28U);
  EXPECT_EQ(pyramid.level(3).size(), 12U);
  EXPECT_EQ(pyramid.level(2).size(), 4U);
  EXPECT_EQ(pyramid.level(1).size(), 1U);
  EXPECT_DOUBLE_EQ(pyramid.grid.square_radius(1), std::sqrt(0.5));
  EXPECT_EQ(pyramid.level(1).center.at(0), Vec2(0.0, 0.0));
}

TEST(Pyramid2, AgreesWithTheTestOfEverySquareAndTriangle) {
  for (const std::string& name : geometry::plane_generator_names()) {
    const geometry::Mesh2 mesh = plane(name);
    const SquareGrid grid = square_grid_around(mesh);
    for (const int level : {1, 3, 6}) {
      std::size_t count = 0;
      const auto side = static_cast<std::uint16_t>(1 << (level - 1));
      for (std::uint16_t iy = 0; iy < side; ++iy)
        for (std::uint16_t ix = 0; ix < side; ++ix) {
          const Vec2 p = grid.square_center(level, {ix, iy});
          const auto holds = [&](const geometry::Triangle& t) {
            for (std::size_t e = 0; e < 3; ++e) {
              const Vec2 a = mesh.vertices[t[e]];
              const Vec2 b = mesh.vertices[t[(e + 1) % 3]];
              const Vec2 edge = b - a;
              const Vec2 to = p - a;
              if (edge.x() * to.y() - edge.y() * to.x() < -1e-15) return false;
            }
            return true;
          };
          count += std::any_of(mesh.triangles.begin(), mesh.triangles.end(), holds) ? 1U : 0U;
        }
      EXPECT_EQ(squares_inside(mesh, grid, level).size(), count) << name << " level " << level;
    }
  }
}

TEST(Pyramid2, ChildrenBelongToTheirParents) {
  const Pyramid2 pyramid = make_pyramid2(plane("cross"), 7);
  for (int h = 1; h < 7; ++h) {
    const PyramidLevel2& parents = pyramid.level(h);
    const PyramidLevel2& children = pyramid.level(h + 1);
    ASSERT_EQ(parents.first_child.size(), parents.size() + 1);
    EXPECT_EQ(parents.first_child.back(), children.size());
    for (std::size_t i = 0; i < parents.size(); ++i) {
      EXPECT_LE(parents.first_child[i + 1] - parents.first_child[i], 4U);
      for (std::size_t c = parents.first_child[i]; c < parents.first_child[i + 1]; ++c) {
        EXPECT_EQ(children.index[c][0] / 2, parents.index[i][0]);
        EXPECT_EQ(children.index[c][1] / 2, parents.index[i][1]);
        // The child's circle touches its parent's from inside (erratum 13).
        EXPECT_NEAR(
            (children.center[c] - parents.center[i]).norm() + pyramid.grid.square_radius(h + 1),
            pyramid.grid.square_radius(h), 1e-14);
      }
    }
  }
}

TEST(Pyramid2, RefusesBadInput) {
  EXPECT_THROW(make_pyramid2(plane("square"), 0), InvalidArgument);
  EXPECT_THROW(make_pyramid2(plane("square"), 10), InvalidArgument);
  EXPECT_THROW(make_pyramid2({}, 3), InvalidArgument);
  // A sliver between the centre lines of level 4.
  const geometry::Mesh2 sliver{{Vec2(0, 0), Vec2(1, 0), Vec2(1, 1e-3)}, {{0, 1, 2}}};
  EXPECT_THROW(make_pyramid2(sliver, 4), InvalidArgument);
}

}  // namespace
}  // namespace gotai::voxel
