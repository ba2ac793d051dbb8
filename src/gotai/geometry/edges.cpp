#include "gotai/geometry/edges.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace gotai::geometry::detail {

std::vector<HalfEdge> sorted_half_edges(std::span<const Triangle> triangles) {
  std::vector<HalfEdge> sides;
  sides.reserve(triangles.size() * 3);
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles[t][k];
      const std::uint32_t b = triangles[t][(k + 1) % 3];
      if (a != b) sides.push_back({std::min(a, b), std::max(a, b), t, a < b});
    }
  std::ranges::sort(sides, [](const HalfEdge& a, const HalfEdge& b) {
    return std::tie(a.low, a.high, a.triangle, a.forward) <
           std::tie(b.low, b.high, b.triangle, b.forward);
  });
  return sides;
}

DisjointSets::DisjointSets(std::size_t count) : parent_(count) {
  std::iota(parent_.begin(), parent_.end(), 0U);
}

std::uint32_t DisjointSets::find(std::uint32_t element) {
  while (parent_[element] != element) {
    parent_[element] = parent_[parent_[element]];
    element = parent_[element];
  }
  return element;
}

void DisjointSets::unite(std::uint32_t a, std::uint32_t b) {
  a = find(a);
  b = find(b);
  parent_[std::max(a, b)] = std::min(a, b);
}

double enclosed_volume(const std::vector<Vec3>& vertices, std::span<const Triangle> triangles,
                       const Vec3& origin) {
  double six_volumes = 0.0;
  for (const auto& [a, b, c] : triangles)
    six_volumes += (vertices[a] - origin).cross(vertices[b] - origin).dot(vertices[c] - origin);
  return six_volumes / 6.0;
}

}  // namespace gotai::geometry::detail
