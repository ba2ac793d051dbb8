/// @file
/// Moves bodies: velocities by gravity and impulses, poses by velocities [Makino 2007,
/// section 4.4].
#pragma once

#include "gotai/model/body_state.h"
#include "gotai/model/step.h"

namespace gotai::dynamics {

/// External loads of the coming step, per body, about the centre of mass; cleared after the step.
struct Loads {
  std::vector<Vec3> force;   ///< [N], W; without gravity
  std::vector<Vec3> torque;  ///< [N m], W
};

/// v += (g + F/m) dt and L += torque dt for dynamic bodies; refreshes w.
void advance_velocities(model::BodyState& bodies, const Vec3& gravity, const Loads& loads,
                        double dt);

/// Adds velocity and angular momentum changes of an update; refreshes w.
void apply_update(model::BodyState& bodies, const model::Update& update);

/// x += v dt, q by torque-free rotation that conserves L (semi-implicit: symplectic splitting in
/// principal axes, erratum 26); push velocities of the update are added to the motion and
/// forgotten.
void advance_poses(model::BodyState& bodies, const model::Update& update, double dt);

/// x += v dt, q = dq(w dt) q with constant w (literal 4.19, 4.24); L follows the new orientation.
void advance_poses_explicit(model::BodyState& bodies, double dt);

}  // namespace gotai::dynamics
