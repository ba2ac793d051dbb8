// The choice of few contacts: what it keeps, what it preserves, and the error that it states.
#include "gotai/collision/reduction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "gotai/core/random.h"

namespace gotai::collision {
namespace {

std::vector<ContactCandidate> random_candidates(Random& random, std::size_t count) {
  std::vector<ContactCandidate> candidates(count);
  for (std::size_t i = 0; i < count; ++i) {
    ContactCandidate& c = candidates[i];
    c.point_A = 0.5 * random.unit_vector();
    c.normal_A = random.unit_vector();
    c.gap = random.uniform(-0.01, 0.01);
    c.area = random.uniform(0.1, 1.0);
    c.share_A = c.point_A;
    c.feature = 3 * i;
  }
  return candidates;
}

double wrench_distance(const ContactCandidate& x, const ContactCandidate& y, double length) {
  const Vec3 moment = x.point_A.cross(x.normal_A) - y.point_A.cross(y.normal_A);
  return std::sqrt((x.normal_A - y.normal_A).squaredNorm() +
                   moment.squaredNorm() / (length * length));
}

TEST(Reduction, KeepsFewAndStatesHowFarTheOthersAre) {
  Random random(21);
  Reduction reduction;
  for (const std::size_t count : {1U, 2U, 7U, 8U, 9U, 40U, 300U}) {
    const std::vector<ContactCandidate> before = random_candidates(random, count);
    std::vector<ContactCandidate> candidates = before;
    reduce_contacts(candidates, {}, {1.0, 1e-4}, reduction);
    ASSERT_GE(reduction.kept.size(), std::min<std::size_t>(count, 1));
    ASSERT_LE(reduction.kept.size(), std::min(count, kMaxReduced));
    EXPECT_TRUE(std::is_sorted(reduction.kept.begin(), reduction.kept.end()));
    double farthest = 0.0;
    for (const ContactCandidate& c : before) {
      double nearest = 1e9;
      for (const std::uint32_t k : reduction.kept) {
        nearest = std::min(nearest, wrench_distance(c, before[k], 1.0));
      }
      farthest = std::max(farthest, nearest);
    }
    EXPECT_NEAR(farthest, count <= kMaxReduced ? 0.0 : reduction.error, 1e-5);
  }
}

// Bits, not values: what a run computes must not depend on the processor.
TEST(Reduction, ChoosesWithTheSameBitsOnEveryKernel) {
  for (const Kernel kernel : {Kernel::avx2, Kernel::avx512}) {
    if (!is_available(kernel)) continue;
    Random random(23);
    for (const std::size_t count : {8U, 16U, 64U}) {
      WrenchLanes lanes;
      const auto fill = [&](std::vector<float>& column, double low, double high) {
        column.resize(count);
        for (float& x : column) x = static_cast<float>(random.uniform(low, high));
      };
      for (std::vector<float>& part : lanes.wrench) fill(part, -1.0, 1.0);
      fill(lanes.reaches, 0.0, 2.0);
      fill(lanes.weight, 0.0, 1.0);
      fill(lanes.distance, 9.0, 9.0);
      lanes.distance.back() = -1.0F;  // padding
      fill(lanes.likeness, 9.0, 9.0);
      lanes.nearest.assign(count, 0);
      WrenchLanes others = lanes;
      std::uint32_t chosen = 1;
      for (std::uint32_t k = 0; k < 6; ++k) {
        const FarthestWrench portable = keep_wrench(lanes, chosen, k, 1e-4F, Kernel::portable);
        const FarthestWrench other = keep_wrench(others, chosen, k, 1e-4F, kernel);
        EXPECT_LT(lanes.distance[chosen], 0.0F);
        ASSERT_EQ(portable.index, other.index);
        EXPECT_EQ(portable.squared, other.squared);
        EXPECT_EQ(lanes.distance, others.distance);
        EXPECT_EQ(lanes.likeness, others.likeness);
        EXPECT_EQ(lanes.nearest, others.nearest);
        ASSERT_LT(portable.index, count - 1);
        for (std::size_t i = 0; i < count; ++i) {
          EXPECT_LE(lanes.distance[i] * lanes.weight[i],
                    lanes.distance[portable.index] * lanes.weight[portable.index]);
        }
        chosen = portable.index;
      }
    }
  }
}

TEST(Reduction, PreservesAreaAndItsMoment) {
  Random random(22);
  Reduction reduction;
  const std::vector<ContactCandidate> before = random_candidates(random, 100);
  std::vector<ContactCandidate> candidates = before;
  reduce_contacts(candidates, {}, {1.0, 1e-4}, reduction);
  double area = 0.0;
  Vec3 moment = Vec3::Zero();
  for (const ContactCandidate& c : before) {
    area += c.area;
    moment += c.area * c.point_A;
  }
  for (const std::uint32_t k : reduction.kept) {
    area -= candidates[k].area;
    moment -= candidates[k].area * candidates[k].share_A;
  }
  EXPECT_NEAR(area, 0.0, 1e-12);
  EXPECT_NEAR(moment.norm(), 0.0, 1e-12);
}

TEST(Reduction, KeepsTheDeepestUnlessARememberedOneIsNearlyAsDeep) {
  Random random(23);
  Reduction reduction;
  std::vector<ContactCandidate> candidates = random_candidates(random, 50);
  for (ContactCandidate& c : candidates) c.gap = 0.0;
  candidates[17].gap = -0.01;
  candidates[30].gap = -0.0099;
  model::ContactMemory::Entry entry;
  entry.feature = candidates[30].feature;
  entry.impulse_W = Vec3::UnitZ();
  const auto kept = [&](std::uint32_t i) {
    return std::count(reduction.kept.begin(), reduction.kept.end(), i) == 1;
  };
  reduce_contacts(candidates, {}, {1.0, 1e-3}, reduction);
  EXPECT_TRUE(kept(17));
  reduce_contacts(candidates, {&entry, 1}, {1.0, 1e-5}, reduction);
  EXPECT_TRUE(kept(17));
  EXPECT_TRUE(kept(30));
  // All alike but for the depth: the remembered one is enough.
  for (ContactCandidate& c : candidates) {
    c.point_A = Vec3::Zero();
    c.normal_A = Vec3::UnitZ();
  }
  reduce_contacts(candidates, {&entry, 1}, {1.0, 1e-3}, reduction);
  EXPECT_EQ(reduction.kept, std::vector<std::uint32_t>{30});
}

TEST(Reduction, KeepsTheLargestCarriers) {
  Random random(24);
  Reduction reduction;
  std::vector<ContactCandidate> candidates = random_candidates(random, 60);
  std::vector<model::ContactMemory::Entry> memory(20);
  for (std::size_t i = 0; i < memory.size(); ++i) {
    memory[i].feature = candidates[2 * i].feature;
    memory[i].impulse_W = Vec3::UnitX() * static_cast<double>((i * 7) % 20);
  }
  reduce_contacts(candidates, memory, {1.0, 1e-4}, reduction);
  for (std::size_t i = 0; i < memory.size(); ++i) {
    if ((i * 7) % 20 >= 20 - kMaxRemembered) {
      EXPECT_TRUE(std::count(reduction.kept.begin(), reduction.kept.end(),
                             static_cast<std::uint32_t>(2 * i)) == 1);
    }
  }
}

// Spinning friction of a square face under even pressure: the shares keep its lever arm (0.3826
// edges), where the kept points alone, at the rim, would brake 1.6 times as hard (Fig. 5-5).
TEST(Reduction, SharesKeepTheLeverArmOfASquarePatch) {
  const int n = 32;
  std::vector<ContactCandidate> candidates;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      ContactCandidate c;
      c.point_A = {(i + 0.5) / n - 0.5, (j + 0.5) / n - 0.5, -0.5};
      c.normal_A = Vec3::UnitZ();
      c.area = 1.0 / (n * n);
      c.feature = candidates.size();
      candidates.push_back(c);
    }
  }
  Reduction reduction;
  reduce_contacts(candidates, {}, {1.0, 1e-4}, reduction);
  double shares = 0.0;
  for (const std::uint32_t k : reduction.kept) {
    shares += candidates[k].area * candidates[k].share_A.head<2>().norm();
  }
  EXPECT_NEAR(shares, 0.3826, 0.01 * 0.3826);
}

// Whatever the motion: friction on few shares is the friction on all of their parts.
TEST(Reduction, SlidingSharesCarryTheFrictionOfAllTheirParts) {
  Random random(29);
  Reduction reduction;
  double worst = 0.0;
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<ContactCandidate> before = random_candidates(random, 200);
    const Vec3 n = random.unit_vector();
    for (ContactCandidate& c : before) {
      c.point_A += 0.4 * random.unit_vector();
      c.point_A += (0.3 - n.dot(c.point_A)) * n;
      c.normal_A = n;
      c.gap = 0.0;
    }
    SlipField slip;
    slip.w_A = random.unit_vector();
    // From spinning in place to sliding straight on: the axis is anywhere in the patch or far out.
    const double distance = std::pow(10.0, random.uniform(-2.0, 3.0));
    slip.v_A = slip.w_A.cross(-distance * random.unit_vector());
    const auto direction = [&](const Vec3& at) {
      const Vec3 v = slip.at(at);
      return Vec3((v - n.dot(v) * n).normalized());
    };
    Vec3 force = Vec3::Zero();
    Vec3 moment = Vec3::Zero();
    double total = 0.0;
    for (const ContactCandidate& c : before) {
      force += c.area * direction(c.point_A);
      moment += c.area * c.point_A.cross(direction(c.point_A));
      total += c.area;
    }
    std::vector<ContactCandidate> candidates = before;
    reduce_contacts(candidates, {}, {1.0, 1e-4}, reduction, &slip);
    ASSERT_EQ(reduction.sliding.size(), reduction.kept.size());
    for (std::size_t k = 0; k < reduction.kept.size(); ++k) {
      const ShareFriction& share = reduction.sliding[k];
      EXPECT_GE(share.alignment, 0.0);
      EXPECT_LE(share.alignment, 1.0);
      const Vec3 f = share.area * share.alignment * direction(share.point_A);
      force -= f;
      moment -= share.point_A.cross(f);
    }
    EXPECT_LE(force.norm(), 0.02 * total) << trial;
    EXPECT_LE(std::abs(n.dot(moment)), 0.02 * total) << trial;
    worst = std::max({worst, force.norm() / total, std::abs(n.dot(moment)) / total});
  }
  RecordProperty("worst", std::to_string(worst));
}

TEST(Reduction, PatchesThatAreNotFlatHaveNoSlidingShares) {
  Random random(30);
  Reduction reduction;
  std::vector<ContactCandidate> candidates = random_candidates(random, 50);
  const SlipField slip{Vec3::UnitX(), Vec3::UnitZ()};
  reduce_contacts(candidates, {}, {1.0, 1e-4}, reduction, &slip);
  EXPECT_TRUE(reduction.sliding.empty());
}

}  // namespace
}  // namespace gotai::collision
