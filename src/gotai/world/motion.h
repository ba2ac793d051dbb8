/// @file
/// Key-framed motion of kinematic bodies.
#pragma once

#include <vector>

#include "gotai/core/types.h"
#include "gotai/world/body_description.h"

namespace gotai {

/// Pose of the mesh frame at a time [s]: linear in position, along the great arc in rotation, held
/// before the first and after the last frame.
/// @param frames  at least one, ascending times
Pose motion_pose(const std::vector<KeyFrame>& frames, double time);

/// Constant angular velocity that turns one orientation into another in dt, the short way [rad/s],
/// W.
Vec3 rotation_rate(const Quat& from, const Quat& to, double dt);

}  // namespace gotai
