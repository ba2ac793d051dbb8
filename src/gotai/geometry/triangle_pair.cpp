#include "gotai/geometry/triangle_pair.h"

#include <algorithm>
#include <array>

#include "gotai/geometry/predicates.h"

namespace gotai::geometry::detail {

namespace {

using Corners = std::array<Vec3, 3>;

Corners corners_of(const std::vector<Vec3>& vertices, const Triangle& t) {
  return {vertices[t[0]], vertices[t[1]], vertices[t[2]]};
}

/// Along this axis the triangle's shadow is largest; dropping it keeps the triangle's shape.
Eigen::Index dominant_axis(const Corners& t) {
  Eigen::Index axis = 0;
  (t[1] - t[0]).cross(t[2] - t[0]).cwiseAbs().maxCoeff(&axis);
  return axis;
}

Vec2 drop_axis(const Vec3& p, Eigen::Index axis) { return {p[(axis + 1) % 3], p[(axis + 2) % 3]}; }

/// On the closed segment a b; all three are collinear.
bool is_between(const Vec2& a, const Vec2& b, const Vec2& p) {
  return p.x() >= std::min(a.x(), b.x()) && p.x() <= std::max(a.x(), b.x()) &&
         p.y() >= std::min(a.y(), b.y()) && p.y() <= std::max(a.y(), b.y());
}

bool segments_meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const int abc = orientation(a, b, c);
  const int abd = orientation(a, b, d);
  const int cda = orientation(c, d, a);
  const int cdb = orientation(c, d, b);
  if (abc * abd < 0 && cda * cdb < 0) return true;
  return (abc == 0 && is_between(a, b, c)) || (abd == 0 && is_between(a, b, d)) ||
         (cda == 0 && is_between(c, d, a)) || (cdb == 0 && is_between(c, d, b));
}

bool contains(const std::array<Vec2, 3>& t, const Vec2& p) {
  const int s0 = orientation(t[0], t[1], p);
  const int s1 = orientation(t[1], t[2], p);
  const int s2 = orientation(t[2], t[0], p);
  return (s0 >= 0 && s1 >= 0 && s2 >= 0) || (s0 <= 0 && s1 <= 0 && s2 <= 0);
}

/// The closed segment p q against the closed triangle, all in one plane.
bool coplanar_segment_meets(const Vec3& p, const Vec3& q, const Corners& t) {
  const Eigen::Index axis = dominant_axis(t);
  const std::array<Vec2, 3> flat = {drop_axis(t[0], axis), drop_axis(t[1], axis),
                                    drop_axis(t[2], axis)};
  const Vec2 a = drop_axis(p, axis);
  const Vec2 b = drop_axis(q, axis);
  if (contains(flat, a) || contains(flat, b)) return true;
  for (std::size_t k = 0; k < 3; ++k)
    if (segments_meet(a, b, flat[k], flat[(k + 1) % 3])) return true;
  return false;
}

/// The closed segment p q against the closed triangle.
/// @param side_p, side_q  sides of the triangle's plane on which p and q lie
bool segment_meets(const Vec3& p, const Vec3& q, int side_p, int side_q, const Corners& t) {
  if (side_p * side_q > 0) return false;
  if (side_p == 0 && side_q == 0) return coplanar_segment_meets(p, q, t);
  const int s0 = orientation(p, q, t[0], t[1]);
  const int s1 = orientation(p, q, t[1], t[2]);
  if (s0 * s1 < 0) return false;
  const int s2 = orientation(p, q, t[2], t[0]);
  return (s0 >= 0 && s1 >= 0 && s2 >= 0) || (s0 <= 0 && s1 <= 0 && s2 <= 0);
}

bool segment_meets(const Vec3& p, const Vec3& q, const Corners& t) {
  return segment_meets(p, q, orientation(t[0], t[1], t[2], p), orientation(t[0], t[1], t[2], q), t);
}

std::array<int, 3> sides_of(const Corners& s, const Corners& t) {
  return {orientation(t[0], t[1], t[2], s[0]), orientation(t[0], t[1], t[2], s[1]),
          orientation(t[0], t[1], t[2], s[2])};
}

bool all_on_one_side(const std::array<int, 3>& sides) {
  return sides[0] != 0 && sides[0] == sides[1] && sides[1] == sides[2];
}

bool any_edge_meets(const Corners& s, const std::array<int, 3>& sides, const Corners& t) {
  for (std::size_t k = 0; k < 3; ++k)
    if (segment_meets(s[k], s[(k + 1) % 3], sides[k], sides[(k + 1) % 3], t)) return true;
  return false;
}

bool disjoint_triangles_meet(const Corners& s, const Corners& t) {
  const std::array<int, 3> s_sides = sides_of(s, t);
  if (all_on_one_side(s_sides)) return false;
  const std::array<int, 3> t_sides = sides_of(t, s);
  if (all_on_one_side(t_sides)) return false;
  return any_edge_meets(s, s_sides, t) || any_edge_meets(t, t_sides, s);
}

/// Triangles a, b, c and a, b, d: they overlap only when folded onto each other.
bool folded(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  if (orientation(a, b, c, d) != 0) return false;
  const Eigen::Index axis = dominant_axis({a, b, c});
  const auto flat = [axis](const Vec3& p) { return drop_axis(p, axis); };
  return orientation(flat(a), flat(b), flat(c)) == orientation(flat(a), flat(b), flat(d));
}

}  // namespace

bool triangles_intersect(const std::vector<Vec3>& vertices, const Triangle& s, const Triangle& t) {
  std::array<std::size_t, 3> s_shared;
  std::array<std::size_t, 3> t_shared;
  std::size_t shared = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      if (s[i] == t[j]) {
        s_shared[shared] = i;
        t_shared[shared++] = j;
      }
  const Corners a = corners_of(vertices, s);
  const Corners b = corners_of(vertices, t);
  if (shared == 0) return disjoint_triangles_meet(a, b);
  if (shared == 1) {
    // Beyond the common corner, one of the sides opposite to it must reach the other triangle.
    const std::size_t i = s_shared[0];
    const std::size_t j = t_shared[0];
    return segment_meets(a[(i + 1) % 3], a[(i + 2) % 3], b) ||
           segment_meets(b[(j + 1) % 3], b[(j + 2) % 3], a);
  }
  return folded(a[s_shared[0]], a[s_shared[1]], a[3 - s_shared[0] - s_shared[1]],
                b[3 - t_shared[0] - t_shared[1]]);
}

}  // namespace gotai::geometry::detail
