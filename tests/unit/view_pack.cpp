#include "gotai/view/pack.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <numbers>

#include "gotai/core/random.h"

namespace gotai::view {
namespace {

// The readers below are written from the description of the formats, not from the writers.

Quat unpack(const std::array<std::uint16_t, 3>& words) {
  const unsigned largest = ((words[0] >> 15U) << 1U) | (words[1] >> 15U);
  std::array<double, 4> c{};
  double sum = 0.0;
  for (unsigned i = 0, k = 0; i < 4; ++i) {
    if (i == largest) continue;
    c[i] = ((words[k++] & 0x7fffU) / 32766.0 * 2.0 - 1.0) / std::numbers::sqrt2;
    sum += c[i] * c[i];
  }
  c[largest] = std::sqrt(1.0 - sum);
  return {c[0], c[1], c[2], c[3]};
}

double half_value(std::uint16_t word) {
  const int exponent = (word >> 10U) & 31U;
  const int fraction = word & 1023U;
  const double size =
      exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024 + fraction, exponent - 25);
  return (word & 0x8000U) != 0 ? -size : size;
}

Vec3 random_vector(Random& random) {
  return {random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)};
}

TEST(PackQuaternion, StaysWithinTheStatedAngle) {
  Random random(5);
  for (int i = 0; i < 20000; ++i) {
    const Vec3 v = random_vector(random);
    const Quat q = Quat(random.uniform(-1.0, 1.0), v.x(), v.y(), v.z()).normalized();
    EXPECT_LT(q.angularDistance(unpack(pack_quaternion(q))), kQuaternionError);
  }
}

TEST(PackQuaternion, IsExactForTheIdentity) {
  const Quat q = unpack(pack_quaternion(Quat::Identity()));
  EXPECT_EQ(q.w(), 1.0);
  EXPECT_EQ(q.vec(), Vec3::Zero());
}

TEST(PackNormal, StaysWithinATenthOfAMilliradian) {
  Random random(6);
  for (int i = 0; i < 5000; ++i) {
    const Vec3 n = random_vector(random).normalized();
    const auto packed = pack_normal(n);
    double x = packed[0] / 32767.0;
    double y = packed[1] / 32767.0;
    const double z = 1.0 - std::abs(x) - std::abs(y);
    if (z < 0.0) {
      const double fold = x;
      x = std::copysign(1.0 - std::abs(y), fold);
      y = std::copysign(1.0 - std::abs(fold), y);
    }
    EXPECT_LT((Vec3(x, y, z).normalized() - n).norm(), 1e-4);
  }
}

TEST(PackHalf, IsTheNearestOfAllWords) {
  for (std::uint32_t word = 0; word < 0x7c00U; ++word)
    ASSERT_EQ(pack_half(half_value(static_cast<std::uint16_t>(word))), word);
  Random random(7);
  for (int i = 0; i < 5000; ++i) {
    const double value = std::exp(random.uniform(-16.0, 11.0));
    const std::uint16_t word = pack_half(value);
    const double error = std::abs(half_value(word) - value);
    EXPECT_LE(error, std::abs(half_value(static_cast<std::uint16_t>(word + 1)) - value));
    EXPECT_LE(error, std::abs(half_value(static_cast<std::uint16_t>(word - 1)) - value));
  }
  EXPECT_EQ(half_value(pack_half(-2.5)), -2.5);
  EXPECT_EQ(half_value(pack_half(1e9)), 65504.0);
  EXPECT_EQ(pack_half(std::nan("")), 0);
}

TEST(Deflate, ComesBackThroughZlib) {
  std::vector<std::uint8_t> bytes(100000);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i / 100 * i);
  const std::vector<std::uint8_t> small = deflate(bytes);
  EXPECT_LT(small.size(), bytes.size());
  std::vector<std::uint8_t> back(bytes.size());
  uLongf size = back.size();
  ASSERT_EQ(uncompress(back.data(), &size, small.data(), small.size()), Z_OK);
  EXPECT_EQ(back, bytes);
}

TEST(Base64, GivesTheExamplesOfTheStandard) {
  const auto encode = [](std::string_view text) {
    return to_base64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  };
  EXPECT_EQ(encode(""), "");
  EXPECT_EQ(encode("f"), "Zg==");
  EXPECT_EQ(encode("fo"), "Zm8=");
  EXPECT_EQ(encode("foobar"), "Zm9vYmFy");
}

}  // namespace
}  // namespace gotai::view
