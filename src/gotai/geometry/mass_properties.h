/// @file
/// Exact mass properties of closed surfaces and tetrahedral meshes.
#pragma once

#include "gotai/core/types.h"
#include "gotai/geometry/mesh.h"

namespace gotai::geometry {

/// Mass properties at density 1 kg/m^3; scale volume and inertia by the density.
struct MassProperties {
  double volume = 0.0;                 ///< [m^3]
  Vec3 center_of_mass = Vec3::Zero();  ///< [m], mesh frame
  Mat3 inertia = Mat3::Zero();         ///< about the centre of mass, axes of the mesh frame [m^5]
};

/// Integrates over the tetrahedra when there are any (absolute volumes), else over the closed
/// surface (divergence theorem). Sums about a local origin, so that far-away meshes lose no digits.
/// @throws InvalidArgument when the volume is not positive and finite
MassProperties mass_properties(const Mesh& mesh);

}  // namespace gotai::geometry
