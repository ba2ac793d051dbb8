#include "gotai/geometry/triangulate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "gotai/core/random.h"

namespace gotai::geometry::detail {
namespace {

double cross(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

double area_of(const std::vector<Vec2>& polygon) {
  double twice = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
    twice += cross(Vec2::Zero(), polygon[i], polygon[(i + 1) % polygon.size()]);
  return twice / 2.0;
}

/// Cuts the polygon, turned in space. Every triangle must face as the polygon does, and together
/// they must have its area: then they fill it without overlap.
void expect_filled(const std::vector<Vec2>& polygon) {
  Random random(11);
  const Quat rotation = random.rotation();
  std::vector<Vec3> vertices;
  vertices.reserve(polygon.size());
  for (const Vec2& p : polygon) vertices.push_back(rotation * Vec3(p.x(), p.y(), 0.0));
  std::vector<std::uint32_t> corners(polygon.size());
  std::iota(corners.begin(), corners.end(), 0U);
  std::vector<Triangle> triangles;
  triangulate(vertices, corners, triangles);
  ASSERT_EQ(triangles.size(), polygon.size() - 2);
  double area = 0.0;
  for (const auto& [a, b, c] : triangles) {
    const double part = cross(polygon[a], polygon[b], polygon[c]) / 2.0;
    EXPECT_GE(part, -1e-12);
    area += part;
  }
  EXPECT_NEAR(area, area_of(polygon), 1e-12 * std::abs(area_of(polygon)));
}

TEST(Triangulate, ConvexAndNotConvex) {
  expect_filled({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  expect_filled({{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}});          // L
  expect_filled({{0, 0}, {4, 0}, {4, 4}, {2, 1}, {0, 4}});                  // a notch
  expect_filled({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {2, 2}, {1, 2}, {0, 2}});  // collinear corners
  expect_filled({{0, 0},
                 {5, 0},
                 {5, 5},
                 {1, 5},
                 {1, 2},
                 {3, 2},
                 {3, 3},
                 {2, 3},
                 {2, 4},
                 {4, 4},
                 {4, 1},
                 {0, 1}});  // a spiral
}

TEST(Triangulate, StarsAndCombs) {
  for (const int points : {5, 20, 200}) {
    std::vector<Vec2> star;
    for (int i = 0; i < 2 * points; ++i) {
      const double angle = std::numbers::pi * i / points;
      const double radius = i % 2 == 0 ? 1.0 : 0.4;
      star.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
    expect_filled(star);
  }
  std::vector<Vec2> comb = {{0, -1}, {40, -1}};
  for (int i = 40; i >= 0; --i) comb.emplace_back(i, i % 2 == 0 ? 5.0 : 0.0);
  expect_filled(comb);
}

TEST(Triangulate, DegeneratePolygonsStillEnd) {
  const std::vector<Vec3> vertices = {{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}, {2, 2, 0}};
  const auto count = [&](const std::vector<std::uint32_t>& corners) {
    std::vector<Triangle> triangles;
    triangulate(vertices, corners, triangles);
    return triangles.size();
  };
  EXPECT_EQ(count({0, 1, 2, 3}), 2U);        // a bow tie
  EXPECT_EQ(count({0, 1, 4, 1}), 2U);        // flat
  EXPECT_EQ(count({0, 2, 2, 1, 3, 0}), 2U);  // repeated corners
  EXPECT_EQ(count({0, 0, 0, 0}), 1U);        // a point: stays visible as one degenerate triangle
}

}  // namespace
}  // namespace gotai::geometry::detail
