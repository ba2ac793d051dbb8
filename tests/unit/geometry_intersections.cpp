#include <gtest/gtest.h>

#include "gotai/core/random.h"
#include "gotai/geometry/generate.h"
#include "gotai/geometry/predicates.h"
#include "gotai/geometry/self_intersections.h"
#include "gotai/geometry/triangle_pair.h"

namespace gotai::geometry {
namespace {

using detail::orientation;

TEST(Orientation, IsExactOnNearlyDegenerateInput) {
  // Points of the plane x + y + z = 1 in dyadic numbers: exactly coplanar, whatever the round-off.
  const Vec3 a(0.5, 0.25, 0.25);
  const Vec3 b(12.0, 12.0, -23.0);
  const Vec3 c(0.125, 0.375, 0.5);
  const Vec3 d(-7.0, 3.0, 5.0);
  EXPECT_EQ(orientation(a, b, c, d), 0);
  const Vec3 above(-7.0, 3.0, std::nextafter(5.0, 6.0));
  const Vec3 below(-7.0, 3.0, std::nextafter(5.0, 4.0));
  EXPECT_EQ(orientation(a, b, c, above), -orientation(a, b, c, below));
  EXPECT_NE(orientation(a, b, c, above), 0);
  EXPECT_EQ(orientation(b, a, c, above), -orientation(a, b, c, above));
  // Kettner et al. 2008, "Classroom examples of robustness problems": plain doubles say otherwise.
  const Vec2 p(0.5, 0.5);
  const Vec2 q(12.0, 12.0);
  const Vec2 r(24.0, 24.0);
  EXPECT_EQ(orientation(p, q, r), 0);
  EXPECT_EQ(orientation(Vec2(0.5, std::nextafter(0.5, 1.0)), q, r), 1);
}

TEST(Orientation, OfCornersInCommonAndPlanesOfTheAxes) {
  Random random(2);
  for (int trial = 0; trial < 300; ++trial) {
    std::array<Vec3, 4> p = {random.unit_vector(), random.unit_vector(), random.unit_vector(),
                             random.unit_vector()};
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(orientation(p[0], p[1], p[2], p[k]), 0);
    const int axis = trial % 3;
    for (Vec3& x : p) x[axis] = 0.1;
    EXPECT_EQ(orientation(p[0], p[1], p[2], p[3]), 0);
    // By a rounding off the plane it is not on it.
    const Vec3 normal = (p[1] - p[0]).cross(p[2] - p[0]);
    p[3][axis] = std::nextafter(0.1, 1.0);
    EXPECT_EQ(orientation(p[0], p[1], p[2], p[3]), normal[axis] > 0.0 ? 1 : -1);
    const Vec2 q(p[0].x(), p[0].y());
    const Vec2 r(p[1].x(), p[1].y());
    EXPECT_EQ(orientation(q, r, r), 0);
    EXPECT_EQ(orientation(q, r, q), 0);
  }
}

TEST(Orientation, OfGeneralInput) {
  Random random(1);
  for (int trial = 0; trial < 1000; ++trial) {
    const Vec3 a = random.unit_vector();
    const Vec3 b = random.unit_vector();
    const Vec3 c = random.unit_vector();
    const Vec3 d = random.unit_vector();
    const double det = (b - a).cross(c - a).dot(d - a);
    if (std::abs(det) > 1e-12) {
      EXPECT_EQ(orientation(a, b, c, d), det > 0.0 ? 1 : -1);
    }
  }
}

bool meet(const std::vector<Vec3>& v, const Triangle& s = {0, 1, 2},
          const Triangle& t = {3, 4, 5}) {
  EXPECT_EQ(detail::triangles_intersect(v, s, t), detail::triangles_intersect(v, t, s));
  return detail::triangles_intersect(v, s, t);
}

TEST(TrianglePair, WithoutCommonVertices) {
  const Vec3 a(0, 0, 0);
  const Vec3 b(4, 0, 0);
  const Vec3 c(0, 4, 0);
  EXPECT_TRUE(meet({a, b, c, {1, 1, -1}, {1, 1, 1}, {9, 9, 1}}));     // pierces
  EXPECT_FALSE(meet({a, b, c, {3, 3, -1}, {3, 3, 1}, {9, 9, 1}}));    // passes by
  EXPECT_FALSE(meet({a, b, c, {1, 1, 1}, {1, 2, 1}, {2, 1, 1}}));     // above
  EXPECT_TRUE(meet({a, b, c, {1, 1, 0}, {1, 2, 1}, {2, 1, 1}}));      // touches with a corner
  EXPECT_TRUE(meet({a, b, c, {2, -1, 0}, {2, 1, 0}, {9, 9, 0}}));     // coplanar, crossing
  EXPECT_TRUE(meet({a, b, c, {1, 1, 0}, {1.5, 1, 0}, {1, 1.5, 0}}));  // coplanar, within
  EXPECT_FALSE(meet({a, b, c, {5, 0, 0}, {9, 0, 0}, {5, 4, 0}}));     // coplanar, apart
}

TEST(TrianglePair, WithOneCommonVertex) {
  const Vec3 o(0, 0, 0);
  const Vec3 b(4, 0, 0);
  const Vec3 c(0, 4, 0);
  const Triangle s = {0, 1, 2};
  const Triangle t = {0, 3, 4};
  EXPECT_FALSE(meet({o, b, c, {-4, 0, 0}, {0, 0, 4}}, s, t));
  EXPECT_TRUE(meet({o, b, c, {1, 1, -1}, {1, 1, 1}}, s, t));    // cuts through
  EXPECT_TRUE(meet({o, b, c, {1, 1, 0}, {-1, -1, 5}}, s, t));   // an edge lies in the other
  EXPECT_TRUE(meet({o, b, c, {5, 5, 0}, {5, 6, 0}}, s, t));     // coplanar wedge
  EXPECT_FALSE(meet({o, b, c, {-5, 5, 0}, {-5, 0, 0}}, s, t));  // coplanar, beside
}

TEST(TrianglePair, WithACommonEdge) {
  const Vec3 a(0, 0, 0);
  const Vec3 b(4, 0, 0);
  const Vec3 c(0, 4, 0);
  const Triangle s = {0, 1, 2};
  const Triangle t = {1, 0, 3};
  EXPECT_FALSE(meet({a, b, c, {1, -1, 0}}, s, t));
  EXPECT_FALSE(meet({a, b, c, {1, 1, 1e-9}}, s, t));
  EXPECT_TRUE(meet({a, b, c, {1, 1, 0}}, s, t));  // folded
}

TEST(SelfIntersections, NoneInAnyGeneratedShape) {
  for (const std::string& name : generator_names())
    EXPECT_EQ(find_self_intersections(generate({.shape = name})).pairs, 0U) << name;
}

/// Two rocks that overlap, compared with every pair of triangles tested.
TEST(SelfIntersections, EqualBruteForce) {
  Mesh mesh = generate({.shape = "rock", .subdivisions = 2});
  Mesh other = generate({.shape = "rock", .subdivisions = 2, .seed = 9});
  const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Vec3& v : other.vertices) mesh.vertices.push_back(v + Vec3(0.3, 0.2, 0.1));
  for (const Triangle& t : other.triangles)
    mesh.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
  std::size_t expected = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (std::size_t j = i + 1; j < mesh.triangles.size(); ++j)
      if (detail::triangles_intersect(mesh.vertices, mesh.triangles[i], mesh.triangles[j]))
        ++expected;
  EXPECT_GT(expected, 50U);
  EXPECT_EQ(find_self_intersections(mesh).pairs, expected);
  for (Vec3& v : mesh.vertices) v = 1e-100 * v;  // counted at any scale
  EXPECT_NEAR(static_cast<double>(find_self_intersections(mesh).pairs),
              static_cast<double>(expected), 2.0);
  const SelfIntersections stopped = find_self_intersections(mesh, 10);
  EXPECT_FALSE(stopped.complete);
}

}  // namespace
}  // namespace gotai::geometry
