#include "gotai/recording/thin_keys.h"

#include <algorithm>
#include <cmath>

namespace gotai::recording {
namespace {

/// Keeps keys greedily: from each the farthest one that `is_good(from, to)` accepts among those
/// that doubling and halving the distance tries.
template <typename IsGood>
std::vector<std::size_t> thin(std::size_t count, const IsGood& is_good) {
  std::vector<std::size_t> kept = {0};
  while (kept.back() + 1 < count) {
    const std::size_t from = kept.back();
    std::size_t reach = 1;  // always good: nothing lies between
    while (from + 2 * reach < count && is_good(from, from + 2 * reach)) reach *= 2;
    for (std::size_t step = reach; step > 0; step /= 2) {
      const std::size_t to = std::min(from + reach + step, count - 1);
      if (to > from + reach && is_good(from, to)) reach = to - from;
    }
    kept.push_back(from + reach);
  }
  return kept;
}

double fraction(const std::vector<double>& times, std::size_t from, std::size_t to,
                std::size_t at) {
  const double span = times[to] - times[from];
  return span > 0.0 ? (times[at] - times[from]) / span : 0.0;
}

}  // namespace

std::vector<std::size_t> thin_positions(const std::vector<double>& times,
                                        const std::vector<Vec3>& positions, double tolerance) {
  const bool moves = std::any_of(positions.begin(), positions.end(), [&](const Vec3& p) {
    return (p - positions.front()).norm() > tolerance;
  });
  if (!moves) return {0};
  return thin(positions.size(), [&](std::size_t from, std::size_t to) {
    for (std::size_t at = from + 1; at < to; ++at) {
      const double s = fraction(times, from, to, at);
      const Vec3 p = (1.0 - s) * positions[from] + s * positions[to];
      if ((p - positions[at]).norm() > tolerance) return false;
    }
    return true;
  });
}

std::vector<std::size_t> thin_rotations(const std::vector<double>& times,
                                        const std::vector<Quat>& rotations, double tolerance) {
  const bool moves = std::any_of(rotations.begin(), rotations.end(), [&](const Quat& q) {
    return q.angularDistance(rotations.front()) > tolerance;
  });
  if (!moves) return {0};
  return thin(rotations.size(), [&](std::size_t from, std::size_t to) {
    // Beyond a quarter turn the way between two keys is no longer unambiguous.
    if (rotations[from].dot(rotations[to]) < std::sqrt(0.5)) return false;
    for (std::size_t at = from + 1; at < to; ++at) {
      const Quat q = rotations[from].slerp(fraction(times, from, to, at), rotations[to]);
      if (q.angularDistance(rotations[at]) > tolerance) return false;
    }
    return true;
  });
}

}  // namespace gotai::recording
