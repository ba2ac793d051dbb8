/// @file
/// Quaternion kinematics [Makino 2007, eqs. 4.20-4.26].
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "gotai/core/types.h"

namespace gotai::dynamics {

/// cos x and (sin x)/x of an angle.
struct CosineAndSinc {
  double cosine;
  double sinc;
};

/// Angles up to its square root are small: their series, with y = x^2, are 1 - y c[0] (1 - y c[1]
/// (... (1 - y c[4]))), to round-off; the first terms left out are below 1e-17 [rad^2].
inline constexpr double kLargestInSeries = 1.0 / 64.0;
inline constexpr std::array<double, 5> kCosineSeries = {1.0 / 2, 1.0 / 12, 1.0 / 30, 1.0 / 56,
                                                        1.0 / 90};
inline constexpr std::array<double, 5> kSincSeries = {1.0 / 6, 1.0 / 20, 1.0 / 42, 1.0 / 72,
                                                      1.0 / 110};

/// Regular at 0, and cheap for the angles of a small step.
/// @param squared  x^2 [rad^2]
inline CosineAndSinc cosine_and_sinc(double squared) {
  if (squared > kLargestInSeries) {
    const double x = std::sqrt(squared);
    return {std::cos(x), std::sin(x) / x};
  }
  const auto series = [squared](const std::array<double, 5>& c) {
    double sum = 1.0;
    for (std::size_t k = c.size(); k-- > 0;) sum = 1.0 - squared * c[k] * sum;
    return sum;
  };
  return {series(kCosineSeries), series(kSincSeries)};
}

/// dq = [cos(|w| dt / 2), w/|w| sin(|w| dt / 2)] (4.24), regular at w = 0.
/// @param w_W  angular velocity [rad/s], W
Quat rotation_increment(const Vec3& w_W, double dt);

/// Rotates by a world-frame angular velocity for dt: dq * q, renormalised (4.25, 4.26; erratum 27).
Quat rotate(const Quat& q_WB, const Vec3& w_W, double dt);

}  // namespace gotai::dynamics
