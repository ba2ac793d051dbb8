#include "gotai/dynamics/rotation.h"

namespace gotai::dynamics {

Quat rotation_increment(const Vec3& w_W, double dt) {
  const auto [cosine, sinc] = cosine_and_sinc(0.25 * dt * dt * w_W.squaredNorm());
  const Vec3 v = (0.5 * dt * sinc) * w_W;
  return {cosine, v.x(), v.y(), v.z()};
}

Quat rotate(const Quat& q_WB, const Vec3& w_W, double dt) {
  return (rotation_increment(w_W, dt) * q_WB).normalized();
}

}  // namespace gotai::dynamics
