/// @file
/// Wall-clock timing.
#pragma once

#include <chrono>

namespace gotai {

/// Starts when it is made.
class Stopwatch {
 public:
  /// Seconds since the start or the last lap().
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  /// Seconds since the start or the last lap; starts anew.
  double lap() {
    const double s = seconds();
    start_ = std::chrono::steady_clock::now();
    return s;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace gotai
