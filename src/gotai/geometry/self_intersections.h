/// @file
/// Where a surface crosses itself.
#pragma once

#include <cstddef>

#include "gotai/geometry/mesh.h"

namespace gotai::geometry {

/// Pairs of triangles that meet anywhere but at the vertices and edges they share.
struct SelfIntersections {
  std::size_t pairs = 0;
  bool complete = true;  ///< false when the search stopped at its limit; `pairs` is a lower bound
};

/// Counts the pairs of triangles of the surface that cross, touch or overlap, beyond what they
/// share. Every decision is exact (the signs of determinants are computed without rounding error);
/// triangles without area are left out. Bounding volume hierarchy, O(n log n + candidates).
/// Expects finite vertices and indices in range.
/// @param most_candidates  pairs with overlapping boxes that are looked at before giving up; 0 is
///        a million and 40 per triangle (ordinary meshes have about 10)
SelfIntersections find_self_intersections(const Mesh& mesh, std::size_t most_candidates = 0);

}  // namespace gotai::geometry
