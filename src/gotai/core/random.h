/// @file
/// Seeded random numbers with the same sequence on every platform (the standard library's
/// distributions differ between implementations).
#pragma once

#include <cstdint>

#include "gotai/core/types.h"

namespace gotai {

/// PCG32 (O'Neill 2014, "PCG: A Family of Simple Fast Space-Efficient Statistically Good
/// Algorithms").
class Random {
 public:
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0);

  std::uint32_t next_u32();
  /// Uniform in [0, 1), 53 bits.
  double uniform();
  /// Uniform in [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Standard normal (Marsaglia's polar method).
  double normal();
  /// Uniform on the unit sphere.
  Vec3 unit_vector();
  /// Uniform rotation (Shoemake 1992).
  Quat rotation();

 private:
  std::uint64_t state_;
  std::uint64_t increment_;
};

}  // namespace gotai
