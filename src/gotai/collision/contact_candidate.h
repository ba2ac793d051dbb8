/// @file
/// A contact that was found, before it is known whether it is kept.
#pragma once

#include <cstddef>

#include "gotai/core/types.h"
#include "gotai/model/contact_set.h"

namespace gotai::collision {

/// A contact of two bodies in the frame of one of them, before it is known whether it is kept.
/// Frame A: axes of body a, origin at its centre of mass.
struct ContactCandidate {
  Vec3 point_A = Vec3::Zero();   ///< on body a [m]
  Vec3 normal_A = Vec3::Zero();  ///< unit, from b to a
  double gap = 0.0;              ///< [m]; the point on b is point_A - gap normal_A
  double area = 0.0;             ///< [m^2], > 0
  /// Centre of the surface it stands for [m]; friction acts there.
  Vec3 share_A = Vec3::Zero();
  model::FeatureKey feature = 0;
  bool crosses = false;    ///< it is where two edges cross, beside its sample
  bool near_edge = false;  ///< the field is not smooth there: its distance is rounded
};

inline constexpr std::size_t kMaxReduced = 8;  ///< contacts kept per pair

}  // namespace gotai::collision
