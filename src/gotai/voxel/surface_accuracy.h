/// @file
/// What a level can resolve of a shape, so that the level can follow from the shape.
#pragma once

#include <vector>

#include "gotai/voxel/distance_field.h"
#include "gotai/voxel/signed_distance.h"
#include "gotai/voxel/surface_samples.h"

namespace gotai::voxel {

/// How thin the body is: the thickness of its walls that all but a hundredth of its surface
/// exceeds. A wall has two sides that face away from each other, so the tip of a wedge is none.
/// @param samples  of the surface; at most about 2,000 of them are looked at
/// @param limit    thicker walls do not matter [m]
/// @return [m]; infinite when (nearly) all walls are thicker than the limit
double wall_thickness(const SignedDistance& surface, const std::vector<SurfaceSample>& samples,
                      double limit);

/// Root mean square error of the interpolated field near the surface, where contacts are [m].
/// @param samples  of the surface; at most about 2,000 of them are looked at
/// @param center   origin of the field's frame S [m], mesh frame
/// @param reach    points are at most this far from the surface [m]
double field_error(const SignedDistance& surface, const std::vector<SurfaceSample>& samples,
                   const DistanceField& field, const Vec3& center, double reach);

}  // namespace gotai::voxel
