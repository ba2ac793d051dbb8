/// @file
/// Which triangles meet at which edge. Internal to the module.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gotai/geometry/mesh.h"

namespace gotai::geometry::detail {

/// One side of a triangle.
struct HalfEdge {
  std::uint32_t low;       ///< smaller vertex
  std::uint32_t high;      ///< larger vertex
  std::uint32_t triangle;  ///< whose side it is
  bool forward;            ///< the triangle runs it from low to high
};

/// The sides of all triangles, sorted by edge, then triangle. Sides with two equal vertices are
/// left out.
std::vector<HalfEdge> sorted_half_edges(std::span<const Triangle> triangles);

/// Calls visit(span of the half edges of one edge) for every edge in order.
template <typename Visit>
void for_each_edge(std::span<const HalfEdge> half_edges, const Visit& visit) {
  for (std::size_t begin = 0; begin < half_edges.size();) {
    std::size_t end = begin + 1;
    while (end < half_edges.size() && half_edges[end].low == half_edges[begin].low &&
           half_edges[end].high == half_edges[begin].high)
      ++end;
    visit(half_edges.subspan(begin, end - begin));
    begin = end;
  }
}

/// Disjoint sets of numbers 0 .. count-1.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count);
  std::uint32_t find(std::uint32_t element);
  void unite(std::uint32_t a, std::uint32_t b);

 private:
  std::vector<std::uint32_t> parent_;
};

/// Volume enclosed by the triangles, by the divergence theorem about `origin`; signed.
double enclosed_volume(const std::vector<Vec3>& vertices, std::span<const Triangle> triangles,
                       const Vec3& origin);

}  // namespace gotai::geometry::detail
