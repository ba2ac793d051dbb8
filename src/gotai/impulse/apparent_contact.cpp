#include "gotai/impulse/apparent_contact.h"

#include <algorithm>
#include <cassert>

namespace gotai::impulse {

ApparentContact apparent_contact(std::span<const Vec3> points, std::span<const Vec3> normals,
                                 std::span<const double> approach) {
  assert(points.size() == normals.size() && points.size() == approach.size());
  constexpr double cancelled = 1e-9;  // of sum w_i
  ApparentContact apparent;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double weight = std::max(-approach[i], 0.0);
    apparent.weight_sum += weight;
    apparent.point += weight * points[i];
    apparent.normal += weight * normals[i];
  }
  apparent.exists = apparent.weight_sum > 0.0;
  if (!apparent.exists) return apparent;
  apparent.point /= apparent.weight_sum;
  apparent.weighted_normal = apparent.normal.norm();
  if (apparent.weighted_normal > cancelled * apparent.weight_sum) {
    apparent.scale = apparent.weighted_normal;
    apparent.normal /= apparent.weighted_normal;
  } else {
    apparent.scale = apparent.weight_sum;
    apparent.normal = Vec3::Zero();
  }
  return apparent;
}

}  // namespace gotai::impulse
