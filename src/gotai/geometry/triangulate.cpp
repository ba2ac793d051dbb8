#include "gotai/geometry/triangulate.h"

#include <algorithm>
#include <cmath>

namespace gotai::geometry::detail {

namespace {

/// Newell's normal: twice the vector area of the polygon.
Vec3 newell_normal(const std::vector<Vec3>& vertices, std::span<const std::uint32_t> corners) {
  const Vec3& origin = vertices[corners[0]];
  Vec3 normal = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    normal += (vertices[corners[i]] - origin).cross(vertices[corners[i + 1]] - origin);
  return normal;
}

/// The polygon in its own plane, counter-clockwise.
std::vector<Vec2> flatten(const std::vector<Vec3>& vertices,
                          std::span<const std::uint32_t> corners) {
  const Vec3 normal = newell_normal(vertices, corners);
  const Vec3 n = normal.norm() > 0.0 ? Vec3(normal.normalized()) : Vec3(Vec3::UnitZ());
  const Vec3 u = n.unitOrthogonal();
  const Vec3 v = n.cross(u);
  std::vector<Vec2> flat;
  flat.reserve(corners.size());
  for (const std::uint32_t c : corners) {
    const Vec3 p = vertices[c] - vertices[corners[0]];
    flat.emplace_back(p.dot(u), p.dot(v));
  }
  return flat;
}

double cross(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// In the triangle or on its border, but not at one of its corners.
bool blocks(const Vec2& p, const Vec2& a, const Vec2& b, const Vec2& c) {
  if (p == a || p == b || p == c) return false;
  return cross(a, b, p) >= 0.0 && cross(b, c, p) >= 0.0 && cross(c, a, p) >= 0.0;
}

/// How good an ear is: twice its area over its longest edge squared; <= 0 for none.
double quality(const std::vector<Vec2>& flat, const std::vector<std::uint32_t>& ring,
               std::size_t at, std::size_t& budget) {
  const std::size_t n = ring.size();
  const Vec2& a = flat[ring[(at + n - 1) % n]];
  const Vec2& b = flat[ring[at]];
  const Vec2& c = flat[ring[(at + 1) % n]];
  const double area = cross(a, b, c);
  if (!(area > 0.0)) return area;
  if (budget < n) return 0.0;
  budget -= n;
  for (const std::uint32_t other : ring)
    if (blocks(flat[other], a, b, c)) return 0.0;
  return area / std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
}

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

/// The best ear; kNone where a self-crossing or flat polygon has none. Large polygons take the
/// first one, so that the time stays quadratic.
/// @param budget  corners that may still be looked at; without it there is no ear
std::size_t best_ear(const std::vector<Vec2>& flat, const std::vector<std::uint32_t>& ring,
                     std::size_t& budget) {
  std::size_t best = kNone;
  double best_quality = 0.0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const double q = quality(flat, ring, i, budget);
    if (!(q > best_quality)) continue;
    best = i;
    best_quality = q;
    if (ring.size() > 64) break;
  }
  return best;
}

}  // namespace

void triangulate(const std::vector<Vec3>& vertices, std::span<const std::uint32_t> corners,
                 std::vector<Triangle>& triangles) {
  std::vector<std::uint32_t> distinct;
  for (const std::uint32_t c : corners)
    if (distinct.empty() || distinct.back() != c) distinct.push_back(c);
  if (distinct.size() > 3 && distinct.front() == distinct.back()) distinct.pop_back();
  if (corners.size() == 3 || distinct.size() < 3) {
    // A degenerate face stays visible to the checks.
    triangles.push_back({corners[0], corners[1], corners[2]});
    return;
  }
  const std::vector<Vec2> flat = flatten(vertices, distinct);
  std::vector<std::uint32_t> ring(distinct.size());
  for (std::uint32_t i = 0; i < ring.size(); ++i) ring[i] = i;
  // Polygons made to have one ear, always the last one looked at, would take cubic time.
  std::size_t budget = 64 * ring.size() * ring.size();
  for (std::size_t ear = best_ear(flat, ring, budget); ring.size() > 3 && ear != kNone;
       ear = best_ear(flat, ring, budget)) {
    const std::size_t n = ring.size();
    triangles.push_back(
        {distinct[ring[(ear + n - 1) % n]], distinct[ring[ear]], distinct[ring[(ear + 1) % n]]});
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  for (std::size_t i = 1; i + 1 < ring.size(); ++i)
    triangles.push_back({distinct[ring[0]], distinct[ring[i]], distinct[ring[i + 1]]});
}

}  // namespace gotai::geometry::detail
