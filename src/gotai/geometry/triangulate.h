/// @file
/// Polygons to triangles. Internal to the module.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gotai/geometry/mesh.h"

namespace gotai::geometry::detail {

/// Cuts a polygon, convex or not, into corners.size() - 2 triangles of the same orientation by
/// clipping ears in the plane of its mean normal; of the ears at hand the one with the
/// best shape goes first. What has no ear (self-crossing, flat) becomes a fan. Corners repeated in
/// a row count once.
void triangulate(const std::vector<Vec3>& vertices, std::span<const std::uint32_t> corners,
                 std::vector<Triangle>& triangles);

}  // namespace gotai::geometry::detail
