/// @file
/// Quaternion kinematics [Makino 2007, eqs. 4.20-4.26].
#pragma once

#include "gotai/core/types.h"

namespace gotai::dynamics {

/// dq = [cos(|w| dt / 2), w/|w| sin(|w| dt / 2)] (4.24), regular at w = 0.
/// @param w_W  angular velocity [rad/s], W
Quat rotation_increment(const Vec3& w_W, double dt);

/// Rotates by a world-frame angular velocity for dt: dq * q, renormalised (4.25, 4.26; erratum 27).
Quat rotate(const Quat& q_WB, const Vec3& w_W, double dt);

}  // namespace gotai::dynamics
