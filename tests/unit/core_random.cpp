#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "gotai/core/random.h"

namespace gotai {
namespace {

TEST(Random, ReproducesTheReferenceSequenceOfPcg32) {
  // The demo of the reference implementation (seed 42, stream 54).
  Random random(42, 54);
  for (const std::uint32_t expected :
       {0xa15c02b7U, 0x7b47f409U, 0xba1d3330U, 0x83d2f293U, 0xbfa4784bU, 0xcbed606eU}) {
    EXPECT_EQ(random.next_u32(), expected);
  }
}

TEST(Random, SeedsAndStreamsDiffer) {
  EXPECT_EQ(Random(7).next_u32(), Random(7).next_u32());
  EXPECT_NE(Random(7).next_u32(), Random(8).next_u32());
  EXPECT_NE(Random(7, 0).next_u32(), Random(7, 1).next_u32());
}

TEST(Random, UniformStaysInItsRangeWithTheRightMoments) {
  Random random(1);
  double sum = 0.0;
  double squares = 0.0;
  constexpr int n = 100'000;
  for (int i = 0; i < n; ++i) {
    const double x = random.uniform(-2.0, 4.0);
    ASSERT_GE(x, -2.0);
    ASSERT_LT(x, 4.0);
    sum += x;
    squares += x * x;
  }
  const double mean = sum / n;
  EXPECT_NEAR(mean, 1.0, 0.03);                       // 5 standard errors of 6 / sqrt(12 n)
  EXPECT_NEAR(squares / n - mean * mean, 3.0, 0.05);  // 36 / 12
}

TEST(Random, NormalHasMeanZeroAndVarianceOne) {
  Random random(2);
  double sum = 0.0;
  double squares = 0.0;
  constexpr int n = 100'000;
  for (int i = 0; i < n; ++i) {
    const double x = random.normal();
    sum += x;
    squares += x * x;
  }
  EXPECT_NEAR(sum / n, 0.0, 0.016);
  EXPECT_NEAR(squares / n, 1.0, 0.023);
}

TEST(Random, UnitVectorsCoverTheSphereEvenly) {
  Random random(3);
  std::array<int, 8> octants{};
  constexpr int n = 80'000;
  for (int i = 0; i < n; ++i) {
    const Vec3 v = random.unit_vector();
    ASSERT_NEAR(v.norm(), 1.0, 1e-14);
    ++octants[(v.x() > 0 ? 1U : 0U) + (v.y() > 0 ? 2U : 0U) + (v.z() > 0 ? 4U : 0U)];
  }
  for (const int count : octants) EXPECT_NEAR(count, 10'000, 470);  // 5 sigma
}

TEST(Random, RotationsAreUnitAndHaveNoPreferredDirection) {
  Random random(4);
  Vec3 mean = Vec3::Zero();
  constexpr int n = 50'000;
  for (int i = 0; i < n; ++i) {
    const Quat q = random.rotation();
    ASSERT_NEAR(q.norm(), 1.0, 1e-14);
    mean += q * Vec3::UnitX();
  }
  EXPECT_LT((mean / n).norm(), 0.02);
}

}  // namespace
}  // namespace gotai
