/// @file
/// The pose of one body's frame in another's.
#pragma once

#include "gotai/collision/broad_phase.h"
#include "gotai/core/types.h"
#include "gotai/model/body_state.h"

namespace gotai::collision {

/// Pose of frame A in frame B from both poses in the world. The difference is taken first: far from
/// the world's origin the other order would cancel.
inline Pose relative_pose(const Pose& X_WB, const Pose& X_WA) {
  const Quat q_BW = X_WB.q.conjugate();
  return {q_BW * (X_WA.p - X_WB.p), q_BW * X_WA.q};
}

/// Pose of body a in the frame of body b; both at their centres of mass.
inline Pose body_pose(const model::BodyState& bodies, const BodyPair& pair) {
  return relative_pose({bodies.x_W[pair.body_b], bodies.q_WB[pair.body_b]},
                       {bodies.x_W[pair.body_a], bodies.q_WB[pair.body_a]});
}

/// No point nearer to the moving frame's origin than `radius` has moved farther between two poses
/// [m]: a turn by t moves points at a distance r from its axis by 2 r sin(t / 2).
inline double displacement(const Pose& from, const Pose& to, double radius) {
  return (to.p - from.p).norm() + 2.0 * (from.q.conjugate() * to.q).vec().norm() * radius;
}

}  // namespace gotai::collision
