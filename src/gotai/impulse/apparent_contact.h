/// @file
/// The apparent contact point: one contact for all contacts of a pair [Makino 2007, chapter 5].
#pragma once

#include <span>
#include <vector>

#include "gotai/core/types.h"

namespace gotai::impulse {

/// What the contacts of a pair look like from afar, in the corrected signs (errata 36-38):
/// weights w_i = max(-v_i, 0).
struct ApparentContact {
  bool exists = false;           ///< some contact approaches
  Vec3 point = Vec3::Zero();     ///< sum w_i r_i / sum w_i (5.8), in the frame of the points
  Vec3 normal = Vec3::Zero();    ///< sum w_i n_i / |sum w_i n_i| (5.11); zero when they cancel
  double weight_sum = 0.0;       ///< sum w_i [m/s]
  double weighted_normal = 0.0;  ///< |sum w_i n_i| [m/s]
  /// What the impulse is measured along: |sum w_i n_i|, or sum w_i when the normals cancel (as in a
  /// groove) [m/s]. The impulse of contact i is p_a w_i / scale (5.19).
  double scale = 0.0;
};

/// @param points    contact points of one pair [m]
/// @param normals   unit, from b to a
/// @param approach  normal relative velocities [m/s]
ApparentContact apparent_contact(std::span<const Vec3> points, std::span<const Vec3> normals,
                                 std::span<const double> approach);

}  // namespace gotai::impulse
