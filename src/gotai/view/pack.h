/// @file
/// Small encodings of the viewer's data. viewer/src/data reads them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "gotai/core/types.h"

namespace gotai::view {

/// Largest angle between an orientation and its packed form [rad].
inline constexpr double kQuaternionError = 1.5e-4;

/// The three smallest components of a unit quaternion, 15 bits each, with the index of the largest
/// in the top bits of the first two words. The identity is exact.
std::array<std::uint16_t, 3> pack_quaternion(const Quat& q);

/// A unit vector as two octahedral coordinates in [-32767, 32767]; within 1e-4 rad.
std::array<std::int16_t, 2> pack_normal(const Vec3& n);

/// IEEE 754 half-precision word nearest to a value; beyond the range the largest finite number.
/// Not-a-number becomes 0.
std::uint16_t pack_half(double value);

/// zlib's deflate of the bytes.
/// @throws std::bad_alloc when there is no memory
std::vector<std::uint8_t> deflate(std::span<const std::uint8_t> bytes);

/// Base64 without line breaks [RFC 4648, section 4].
std::string to_base64(std::span<const std::uint8_t> bytes);

}  // namespace gotai::view
