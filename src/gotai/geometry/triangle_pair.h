/// @file
/// Do two triangles of a mesh meet where they should not? Internal to the module.
#pragma once

#include <vector>

#include "gotai/geometry/mesh.h"

namespace gotai::geometry::detail {

/// True when the triangles have a point in common beyond the vertices and edges that they share by
/// index. Exact. Neither may be degenerate, nor may they share all three vertices.
bool triangles_intersect(const std::vector<Vec3>& vertices, const Triangle& s, const Triangle& t);

}  // namespace gotai::geometry::detail
