#include "gotai/core/random.h"

#include <cmath>
#include <numbers>

namespace gotai {

Random::Random(std::uint64_t seed, std::uint64_t stream)
    : state_(0), increment_((stream << 1U) | 1U) {
  next_u32();
  state_ += seed;
  next_u32();
}

std::uint32_t Random::next_u32() {
  const std::uint64_t old = state_;
  state_ = old * 6364136223846793005ULL + increment_;
  const auto shifted = static_cast<std::uint32_t>(((old >> 18U) ^ old) >> 27U);
  const auto rotation = static_cast<std::uint32_t>(old >> 59U);
  return (shifted >> rotation) | (shifted << ((32U - rotation) & 31U));
}

double Random::uniform() {
  const std::uint64_t high = next_u32() >> 5U;
  const std::uint64_t low = next_u32() >> 6U;
  return static_cast<double>((high << 26U) | low) * 0x1.0p-53;
}

double Random::normal() {
  for (;;) {
    const double x = uniform(-1.0, 1.0);
    const double y = uniform(-1.0, 1.0);
    const double s = x * x + y * y;
    if (s > 0.0 && s < 1.0) return x * std::sqrt(-2.0 * std::log(s) / s);
  }
}

Vec3 Random::unit_vector() {
  const double z = uniform(-1.0, 1.0);
  const double phi = uniform(0.0, 2.0 * std::numbers::pi);
  const double r = std::sqrt(1.0 - z * z);
  return {r * std::cos(phi), r * std::sin(phi), z};
}

Quat Random::rotation() {
  const double u = uniform();
  const double a = uniform(0.0, 2.0 * std::numbers::pi);
  const double b = uniform(0.0, 2.0 * std::numbers::pi);
  const double r1 = std::sqrt(1.0 - u);
  const double r2 = std::sqrt(u);
  return {r2 * std::cos(b), r1 * std::sin(a), r1 * std::cos(a), r2 * std::sin(b)};
}

}  // namespace gotai
