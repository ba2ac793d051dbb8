/// @file
/// Quaternion kinematics [Makino 2007, eqs. 4.20-4.26].
#pragma once

#include <cmath>

#include "gotai/core/types.h"

namespace gotai::dynamics {

/// cos x and (sin x)/x of an angle.
struct CosineAndSinc {
  double cosine;
  double sinc;
};

/// Regular at 0, and cheap for the angles of a small step: below 1/8 by series, to round-off.
/// @param squared  x^2 [rad^2]
inline CosineAndSinc cosine_and_sinc(double squared) {
  constexpr double kSmall = 1.0 / 64.0;
  if (squared > kSmall) {
    const double x = std::sqrt(squared);
    return {std::cos(x), std::sin(x) / x};
  }
  // The first terms left out are below 1e-17.
  const double y = squared;
  const auto term = [y](double divisor_inverse, double rest) {
    return 1.0 - y * divisor_inverse * rest;
  };
  return {term(1.0 / 2, term(1.0 / 12, term(1.0 / 30, term(1.0 / 56, term(1.0 / 90, 1.0))))),
          term(1.0 / 6, term(1.0 / 20, term(1.0 / 42, term(1.0 / 72, term(1.0 / 110, 1.0)))))};
}

/// dq = [cos(|w| dt / 2), w/|w| sin(|w| dt / 2)] (4.24), regular at w = 0.
/// @param w_W  angular velocity [rad/s], W
Quat rotation_increment(const Vec3& w_W, double dt);

/// Rotates by a world-frame angular velocity for dt: dq * q, renormalised (4.25, 4.26; erratum 27).
Quat rotate(const Quat& q_WB, const Vec3& w_W, double dt);

}  // namespace gotai::dynamics
