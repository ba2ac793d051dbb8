/// @file
/// From bodies and contacts to contact problems.
#pragma once

#include <vector>

#include "gotai/impulse/cone_problem.h"
#include "gotai/impulse/islands.h"
#include "gotai/model/body_state.h"
#include "gotai/model/contact_set.h"
#include "gotai/model/material.h"
#include "gotai/model/step.h"

namespace gotai::impulse {

/// What an impulse has to achieve at a contact besides not penetrating, fixed at the start of a
/// step.
struct ContactTargets {
  std::vector<double> approach;     ///< normal relative velocity before gravity, V [m/s]
  std::vector<double> restitution;  ///< e of the two materials
  std::vector<double> friction;     ///< mu of the two materials, less where shares slide
  std::vector<Vec3> friction_W;     ///< where friction acts [m], W
};

/// Reads V, e, mu and where friction acts of every contact.
/// @param bodies  velocities before gravity
void read_targets(const model::BodyState& bodies, const model::ContactSet& contacts,
                  const model::MaterialTable& materials, ContactTargets& targets);

/// Moves friction to where the resultants of sliding shares act, and limits it to them.
/// @param bodies          velocities before gravity
/// @param stopping_speed  |g| dt: what slips faster slides [m/s]
void slide_friction(const model::BodyState& bodies, const model::ContactSet& contacts,
                    double stopping_speed, ContactTargets& targets);

/// Velocity that is added to the normal row of a contact, so that it ends with v' >= -bias [m/s].
///   gap <= 0   e min(v, 0): bounces off what it hits, no inward push for separating contacts
///              (errata 4, 25)
///   gap > 0    max(gap, 0)/dt, free to close the gap within the step; a fast approach that closes
///              it (v* dt < -gap, v < -2 |g| dt) bounces: e v
/// @param v        normal velocity before gravity
/// @param v_star   normal velocity with gravity
/// @param gravity  |g| [m/s^2]
double row_bias(double v, double v_star, double gap, double restitution, double dt, double gravity);

/// Assembles the contact problem of an island [Makino 2007, eqs. 4.10-4.16].
/// @param bodies   velocities with gravity: V* of q_i = V*_i + bias_i
/// @param gap      per contact [m]
/// @param ridge    compliance as a fraction of trace(A)/n (erratum 23)
/// @param[out] problem  contacts in the order of the island's pairs; patches are the pairs
/// @param[out] frame    contact frame per contact, W
void assemble(const model::BodyState& bodies, const model::ContactSet& contacts,
              const Island& island, const ContactTargets& targets, const std::vector<double>& gap,
              double dt, double gravity, double ridge, ConeProblem& problem,
              std::vector<Mat3>& frame);

/// A block's rows of the Jacobian: how contact velocity follows a body's mass-scaled velocity.
/// @param sign   +1 for body a, -1 for body b
/// @param scale  S with S S' = inverse inertia, W
Jacobian mass_scaled_jacobian(const Mat3& frame, const Vec3& arm_W, double inverse_mass,
                              const Mat3& scale, double sign);

/// S with S S' = inverse inertia [1/(kg m^2)], lower triangular.
Mat3 inertia_scale(const Mat3& inverse_I_W);

}  // namespace gotai::impulse
