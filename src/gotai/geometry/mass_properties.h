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

/// The frame P in which an inertia tensor is diagonal.
struct PrincipalAxes {
  Vec3 moments;  ///< ascending, in the unit of the tensor
  Quat q_BP;     ///< rotation of the principal axes P in the tensor's frame B
};

/// Diagonalises a symmetric inertia tensor: inertia = R(q_BP) diag(moments) R(q_BP)^T.
PrincipalAxes principal_axes(const Mat3& inertia);

}  // namespace gotai::geometry
