/// @file
/// The pose of one body's frame in another's.
#pragma once

#include "gotai/core/types.h"

namespace gotai::collision {

/// Pose of frame A in frame B from both poses in the world. The difference is taken first: far from
/// the world's origin the other order would cancel.
inline Pose relative_pose(const Pose& X_WB, const Pose& X_WA) {
  const Quat q_BW = X_WB.q.conjugate();
  return {q_BW * (X_WA.p - X_WB.p), q_BW * X_WA.q};
}

}  // namespace gotai::collision
