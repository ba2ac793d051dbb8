#include "gotai/impulse/contact_kinematics.h"

#include <cmath>

namespace gotai::impulse {

Vec3 relative_velocity(const model::BodyState& bodies, const model::ContactPair& pair,
                       const Vec3& point_W) {
  const auto at = [&](model::BodyIndex i) {
    return (bodies.v_W[i] + bodies.w_W[i].cross(point_W - bodies.x_W[i])).eval();
  };
  return at(pair.body_a) - at(pair.body_b);
}

Mat3 contact_frame(const Vec3& normal_W) {
  // Duff et al. 2017, "Building an Orthonormal Basis, Revisited": no square root, no case of its
  // own.
  const double x = normal_W.x();
  const double y = normal_W.y();
  const double z = normal_W.z();
  const double sign = std::copysign(1.0, z);
  const double a = -1.0 / (sign + z);
  const double b = x * y * a;
  Mat3 frame;
  frame.col(0) = normal_W;
  frame.col(1) = Vec3(1.0 + sign * x * x * a, sign * b, -sign * x);
  frame.col(2) = Vec3(b, sign + y * y * a, -y);
  return frame;
}

double inverse_effective_mass(const model::BodyState& bodies, const model::ContactPair& pair,
                              const Vec3& point_W, const Vec3& direction_W) {
  double sum = 0.0;
  for (const model::BodyIndex i : {pair.body_a, pair.body_b}) {
    if (!bodies.is_dynamic(i)) continue;
    const Vec3 lever = (point_W - bodies.x_W[i]).cross(direction_W);
    sum += bodies.inverse_mass[i] + lever.dot(bodies.inverse_I_W[i] * lever);
  }
  return sum;
}

void add_impulse(const model::BodyState& bodies, const model::ContactPair& pair,
                 const Vec3& point_W, const Vec3& impulse_W, model::Update& update) {
  const auto act = [&](model::BodyIndex i, const Vec3& impulse) {
    if (!bodies.is_dynamic(i)) return;
    update.delta_v[i] += bodies.inverse_mass[i] * impulse;
    update.delta_L[i] += (point_W - bodies.x_W[i]).cross(impulse);
  };
  act(pair.body_a, impulse_W);
  act(pair.body_b, -impulse_W);
}

}  // namespace gotai::impulse
