/// @file
/// One sample of a shape's surface: where it is, which way it faces, and how much of it.
#pragma once

#include <array>
#include <cstdint>

#include "gotai/core/types.h"
#include "gotai/voxel/surface_model.h"

namespace gotai::collision {

/// The same vector in double precision.
inline Vec3 to_double(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

/// Where the sample is, in the mesh frame [m].
Vec3 sample_point(const voxel::SurfaceModel& model, std::uint32_t sample);

/// The part of a sample's surface that faces the other body [m^2]. Never zero, so that areas can
/// weigh.
/// @param toward  unit, from the sample into the other body; the sample's frame S
double facing_area(const voxel::SurfaceModel& model, std::uint32_t sample, const Vec3& toward);

/// Turns the normal that a field suggests into one that the sample's own surface allows: the
/// nearest direction in the cone of its outward normals, across the edge for samples of an edge.
/// @param toward  unit, from the sample into the other body; the sample's frame S
/// @return the same, within the cone, unit to single precision; zero when the sample faces away
/// from the other body
Vec3 fit_to_normal_cone(const voxel::SurfaceTree& tree, std::uint32_t sample, const Vec3& toward);

}  // namespace gotai::collision
