#include "gotai/world/motion.h"

#include <algorithm>
#include <cmath>

namespace gotai {

Pose motion_pose(const std::vector<KeyFrame>& frames, double time) {
  const auto next = std::upper_bound(frames.begin(), frames.end(), time,
                                     [](double t, const KeyFrame& f) { return t < f.time; });
  if (next == frames.begin()) return frames.front().X_WM;
  if (next == frames.end()) return frames.back().X_WM;
  const KeyFrame& a = *(next - 1);
  const KeyFrame& b = *next;
  const double s = (time - a.time) / (b.time - a.time);
  return {(1.0 - s) * a.X_WM.p + s * b.X_WM.p, a.X_WM.q.slerp(s, b.X_WM.q).normalized()};
}

Vec3 rotation_rate(const Quat& from, const Quat& to, double dt) {
  Quat turn = to * from.conjugate();
  if (turn.w() < 0.0) turn.coeffs() = -turn.coeffs();
  const double sine = turn.vec().norm();
  if (sine == 0.0) return Vec3::Zero();
  const double angle = 2.0 * std::atan2(sine, turn.w());
  return (angle / (sine * dt)) * turn.vec();
}

}  // namespace gotai
