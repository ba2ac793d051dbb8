#include "gotai/dynamics/rotation.h"

#include <cmath>

namespace gotai::dynamics {

Quat rotation_increment(const Vec3& w_W, double dt) {
  const double half_angle = 0.5 * dt * w_W.norm();
  // sin(x)/x by its series where the quotient loses digits.
  const double sinc =
      half_angle < 1e-4 ? 1.0 - half_angle * half_angle / 6.0 : std::sin(half_angle) / half_angle;
  const Vec3 v = (0.5 * dt * sinc) * w_W;
  return {std::cos(half_angle), v.x(), v.y(), v.z()};
}

Quat rotate(const Quat& q_WB, const Vec3& w_W, double dt) {
  return (rotation_increment(w_W, dt) * q_WB).normalized();
}

}  // namespace gotai::dynamics
