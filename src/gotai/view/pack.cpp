#include "gotai/view/pack.h"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <new>
#include <numbers>

namespace gotai::view {

std::array<std::uint16_t, 3> pack_quaternion(const Quat& q) {
  // Even, so that zero falls on a step.
  constexpr double kMax = 32766.0;
  const std::array<double, 4> c{q.w(), q.x(), q.y(), q.z()};
  std::size_t largest = 0;
  for (std::size_t i = 1; i < 4; ++i)
    if (std::abs(c[i]) > std::abs(c[largest])) largest = i;
  const double sign = c[largest] < 0.0 ? -1.0 : 1.0;
  std::array<std::uint16_t, 3> words{};
  std::size_t k = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    if (i == largest) continue;
    const double unit = 0.5 * (sign * c[i] * std::numbers::sqrt2 + 1.0);
    words[k++] = static_cast<std::uint16_t>(std::lround(std::clamp(unit, 0.0, 1.0) * kMax));
  }
  words[0] = static_cast<std::uint16_t>(words[0] | ((largest >> 1U) << 15U));
  words[1] = static_cast<std::uint16_t>(words[1] | ((largest & 1U) << 15U));
  return words;
}

std::array<std::int16_t, 2> pack_normal(const Vec3& n) {
  const double sum = n.cwiseAbs().sum();
  double x = n.x() / sum;
  double y = n.y() / sum;
  if (n.z() < 0.0) {
    const double fold = x;
    x = (1.0 - std::abs(y)) * (fold < 0.0 ? -1.0 : 1.0);
    y = (1.0 - std::abs(fold)) * (y < 0.0 ? -1.0 : 1.0);
  }
  return {static_cast<std::int16_t>(std::lround(x * 32767.0)),
          static_cast<std::int16_t>(std::lround(y * 32767.0))};
}

std::uint16_t pack_half(double value) {
  if (std::isnan(value)) return 0;
  const std::uint32_t sign = std::signbit(value) ? 0x8000U : 0U;
  const double size = std::min(std::abs(value), 65504.0);
  int exponent = 0;
  std::frexp(size, &exponent);
  // Steps of 2^(exponent - 11) for numbers of the form m 2^exponent, 1/2 <= m < 1; below the
  // smallest normal number the step stays 2^-24.
  const int step = std::max(exponent - 11, -24);
  const auto steps = static_cast<std::uint32_t>(std::lround(std::ldexp(size, -step)));
  // A normal number's leading step is implied, and adding carries into the exponent by itself.
  const std::uint32_t bits =
      steps < 1024U ? steps : (static_cast<std::uint32_t>(step + 24) << 10U) + steps;
  return static_cast<std::uint16_t>(sign | bits);
}

std::vector<std::uint8_t> deflate(std::span<const std::uint8_t> bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::vector<std::uint8_t> out(size);
  // Level 6 is zlib's own balance of time and size.
  if (compress2(out.data(), &size, bytes.data(), static_cast<uLong>(bytes.size()), 6) != Z_OK)
    throw std::bad_alloc();
  out.resize(size);
  return out;
}

std::string to_base64(std::span<const std::uint8_t> bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = bytes.size() - i;
    const std::uint32_t b1 = left > 1 ? bytes[i + 1] : 0U;
    const std::uint32_t b2 = left > 2 ? bytes[i + 2] : 0U;
    const std::uint32_t three = (std::uint32_t{bytes[i]} << 16U) | (b1 << 8U) | b2;
    text += kDigits[(three >> 18U) & 63U];
    text += kDigits[(three >> 12U) & 63U];
    text += left > 1 ? kDigits[(three >> 6U) & 63U] : '=';
    text += left > 2 ? kDigits[three & 63U] : '=';
  }
  return text;
}

}  // namespace gotai::view
