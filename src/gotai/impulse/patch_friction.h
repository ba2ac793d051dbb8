/// @file
/// Friction of a patch whose normal impulses are already known.
#pragma once

#include <vector>

#include "gotai/model/body_state.h"
#include "gotai/model/contact_set.h"
#include "gotai/model/step.h"

namespace gotai::impulse {

/// Velocities of the bodies as a sub-step changes them.
struct WorkingVelocities {
  std::vector<Vec3> v_W;  ///< [m/s]
  std::vector<Vec3> w_W;  ///< [rad/s]
  std::vector<Vec3>
      sliding_friction;  ///< of add_patch_friction: full friction per contact [N s], W

  /// Copies the velocities of the state; storage is kept.
  void read(const model::BodyState& bodies);
  /// Velocity of a's material point at a place relative to b's [m/s].
  Vec3 relative(const model::BodyState& bodies, const model::ContactPair& pair,
                const Vec3& point_W) const;
  /// Adds an impulse on a and its reaction on b.
  void add_impulse(const model::BodyState& bodies, const model::ContactPair& pair,
                   const Vec3& point_W, const Vec3& impulse_W);
  /// Changes of dynamic bodies since they were read, as an update.
  void write_changes(const model::BodyState& bodies, model::Update& update) const;
};

/// Normal impulses of the contacts of a pair, acting on the velocities.
/// @param normal_impulse   per contact of the set [N s]; only the pair's are read
/// @param[in,out] contact_impulse  per contact [N s], W; added to
void add_normal_impulses(const model::BodyState& bodies, const model::ContactSet& contacts,
                         const model::ContactPair& pair, const std::vector<double>& normal_impulse,
                         WorkingVelocities& velocities, std::vector<Vec3>& contact_impulse);

/// Coulomb friction mu p_n against the sliding direction of every contact (5.18), scaled down as a
/// whole so that it never reverses the sliding (erratum 41): of the impulses lambda mu p_n t_i with
/// lambda in [0, 1] those that leave the least kinetic energy.
/// @param normal_impulse   per contact of the set [N s]; only the pair's are read
/// @param[in,out] velocities  after the normal impulses
/// @param[in,out] contact_impulse  per contact [N s], W; added to
void add_patch_friction(const model::BodyState& bodies, const model::ContactSet& contacts,
                        const model::ContactPair& pair, double friction,
                        const std::vector<double>& normal_impulse, WorkingVelocities& velocities,
                        std::vector<Vec3>& contact_impulse);

}  // namespace gotai::impulse
