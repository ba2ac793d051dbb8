/// @file
/// Numbers, vectors and matrices into and out of one lane of the kernels' rows.
#pragma once

#include "gotai/core/types.h"
#include "gotai/impulse/soft_kernel.h"

namespace gotai::impulse {

/// Writes lane l, rounded to single precision.
inline void set(Lane& lane, std::size_t l, double v) { lane.value[l] = static_cast<float>(v); }
inline void set(Lane3& lanes, std::size_t l, const Vec3& v) {
  set(lanes.x, l, v.x());
  set(lanes.y, l, v.y());
  set(lanes.z, l, v.z());
}
inline void set(LaneInertia& lanes, std::size_t l, const Mat3& m) {
  set(lanes.xx, l, m(0, 0));
  set(lanes.xy, l, m(0, 1));
  set(lanes.xz, l, m(0, 2));
  set(lanes.yy, l, m(1, 1));
  set(lanes.yz, l, m(1, 2));
  set(lanes.zz, l, m(2, 2));
}
/// The vector in lane l.
inline Vec3 get(const Lane3& lanes, std::size_t l) {
  return {lanes.x.value[l], lanes.y.value[l], lanes.z.value[l]};
}

}  // namespace gotai::impulse
