/// @file
/// Free rotation of eight bodies at a time: plain arrays in, plain arrays out. The same bits come
/// out on every instruction set.
#pragma once

#include <cstddef>

namespace gotai::dynamics {

inline constexpr std::size_t kRotationLanes = 8;

/// Eight dynamic bodies, one per lane. Quaternions are x, y, z, w.
struct RotationLanes {
  struct alignas(64) Row {
    double lane[kRotationLanes];
  };
  Row q_WB[4];               ///< orientation, unit; read and written
  Row q_BP[4];               ///< principal axes P in B
  Row L_W[3];                ///< angular momentum [kg m^2/s]
  Row principal_moments[3];  ///< [kg m^2], > 0
  Row inverse_I_W[6];        ///< xx, xy, xz, yy, yz, zz [1/(kg m^2)], afterwards; written
  Row w_W[3];                ///< angular velocity [rad/s], afterwards; written
};

/// Torque-free rotation that conserves L, and what follows: the inverse inertia to the bits of
/// model::refresh_derived(), which resumed runs start from, and the angular velocity. The kinetic
/// energy is split into a sphere with the middle principal moment, whose flow turns about the fixed
/// L exactly, and the two remaining axes, whose flows turn about a body axis exactly; Strang
/// composition of these is symplectic, of second order, and exact for spheres and symmetric tops
/// (erratum 26).
/// @param dt  [s]
void rotate_free(RotationLanes& bodies, double dt);

}  // namespace gotai::dynamics
