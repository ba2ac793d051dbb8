/// @file
/// Velocities and impulses at contacts.
#pragma once

#include "gotai/model/body_state.h"
#include "gotai/model/contact_set.h"
#include "gotai/model/step.h"

namespace gotai::impulse {

/// Velocity of a's material point at a place relative to b's [m/s], W [Makino 2007, eqs. 4.6, 4.7].
Vec3 relative_velocity(const model::BodyState& bodies, const model::ContactPair& pair,
                       const Vec3& point_W);

/// How a moves relative to b, both rigid: for many contacts of one pair.
struct RelativeMotion {
  Vec3 origin_W;  ///< a's centre of mass [m]
  Vec3 v_W;       ///< of a's material point there relative to b's [m/s]
  Vec3 w_W;       ///< [rad/s]

  RelativeMotion(const model::BodyState& bodies, const model::ContactPair& pair)
      : origin_W(bodies.x_W[pair.body_a]),
        v_W(relative_velocity(bodies, pair, origin_W)),
        w_W(bodies.w_W[pair.body_a] - bodies.w_W[pair.body_b]) {}

  /// The same as direction . relative_velocity() at a point [m/s].
  double along(const Vec3& direction_W, const Vec3& point_W) const {
    return direction_W.dot(v_W) + w_W.dot((point_W - origin_W).cross(direction_W));
  }
};

/// An orthonormal frame whose first column is the given unit vector; the same for equal input.
Mat3 contact_frame(const Vec3& normal_W);

/// Inverse of the mass that a unit impulse along a direction meets at a point [1/kg]:
/// 1/m_A + 1/m_B + d . ((I_A^-1 (r_A x d)) x r_A + (I_B^-1 (r_B x d)) x r_B) (4.10; erratum 20).
double inverse_effective_mass(const model::BodyState& bodies, const model::ContactPair& pair,
                              const Vec3& point_W, const Vec3& direction_W);

/// Adds an impulse on a, and its reaction on b, to the changes of an update. Bodies with inverse
/// mass 0 take nothing.
/// @param impulse_W  [N s]
void add_impulse(const model::BodyState& bodies, const model::ContactPair& pair,
                 const Vec3& point_W, const Vec3& impulse_W, model::Update& update);

}  // namespace gotai::impulse
