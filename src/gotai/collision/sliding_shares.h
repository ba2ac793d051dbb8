/// @file
/// Friction of a flat patch that slides, share by share [Contensou 1963].
#pragma once

#include <array>
#include <span>

#include "gotai/collision/contact_candidate.h"
#include "gotai/collision/wrench_lanes.h"

namespace gotai::collision {

/// How body a moves along body b, in frame A.
struct SlipField {
  Vec3 v_A = Vec3::Zero();  ///< of a's centre of mass against b [m/s]
  Vec3 w_A = Vec3::Zero();  ///< [rad/s]

  /// Velocity of a's material point relative to b's [m/s].
  Vec3 at(const Vec3& point_A) const { return v_A + w_A.cross(point_A); }
};

/// Friction of the share of a patch that one contact stands for.
struct ShareFriction {
  double area = 0.0;             ///< [m^2]
  Vec3 centre_A = Vec3::Zero();  ///< of the share [m]
  Vec3 point_A = Vec3::Zero();   ///< where the resultant acts [m]
  double alignment = 1.0;        ///< length of the mean direction of slip, in [0, 1]
};
using SharesFriction = std::array<ShareFriction, kMaxReduced>;

/// Finds where friction acts on each share of a flat patch under even pressure. Every part of it is
/// opposed to its own slip: of all of them together, the share gets the force
/// F = sum of area * direction, and the moment M about its centre. A rigid motion slips in the
/// direction of F along a whole line, and F acts on one point of that line with the moment M: there
/// a single friction force does what all parts do. Points are kept within `reach` of the centre of
/// their share; the moment that is missing then is shared among all by moving all points across
/// their slip alike, so that force and moment of the patch remain exact.
///
/// Samples of either body cut the same patch into parts. Those of the body that is sampled more
/// finely there know it better, and weigh more, as those do that nearly touch.
/// @param lanes   which share a candidate belongs to
/// @param normal  unit, of the patch, frame A
/// @param reach   [m], > 0
/// @param[out] shares  the first `count`, in the order of their choice
/// @return false if nothing slips
bool find_sliding_shares(std::span<const ContactCandidate> candidates, const WrenchLanes& lanes,
                         const Vec3& normal, double reach, const SlipField& slip, std::size_t count,
                         SharesFriction& shares);

}  // namespace gotai::collision
