#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "gotai/core/parallel.h"

namespace gotai {
namespace {

// A sum whose bits depend on the order of its terms.
double ordered_sum(int threads) {
  const ThreadLimit limit(threads);
  std::vector<double> terms(10'007);
  parallel_for(terms.size(), 16, [&](std::size_t i) {
    terms[i] = std::sin(static_cast<double>(i)) * std::exp2(static_cast<double>(i % 60));
  });
  return std::accumulate(terms.begin(), terms.end(), 0.0);
}

TEST(ParallelFor, GivesTheSameBitsForAnyNumberOfThreads) {
  const double one = ordered_sum(1);
  for (const int threads : {1, 2, 4, 7, 0}) EXPECT_EQ(ordered_sum(threads), one) << threads;
}

TEST(ParallelFor, GivesTheSameBitsInATeam) {
  const double one = ordered_sum(1);
  for (const int threads : {1, 2, 4, 7}) {
    const ThreadLimit limit(threads);
    const ThreadTeam team;
    EXPECT_EQ(ordered_sum(threads), one) << threads;
  }
}

TEST(ParallelFor, VisitsEveryIndexOnceInATeam) {
  const ThreadLimit limit(4);
  const ThreadTeam team;
  for (int repeat = 0; repeat < 50; ++repeat) {
    for (const std::size_t count : {0U, 1U, 15U, 16U, 17U, 1000U}) {
      std::vector<int> visits(count, 0);
      parallel_for(count, 16, [&](std::size_t i) { ++visits[i]; });
      for (const int n : visits) ASSERT_EQ(n, 1);
    }
  }
  std::vector<int> nested(40, 0);
  parallel_for(nested.size(), 1,
               [&](std::size_t i) { parallel_for(100, 1, [&](std::size_t) { ++nested[i]; }); });
  for (const int n : nested) EXPECT_EQ(n, 100);
  EXPECT_THROW(parallel_for(1000, 1,
                            [](std::size_t i) {
                              if (i == 777) throw std::runtime_error("index 777");
                            }),
               std::runtime_error);
}

TEST(ParallelFor, VisitsEveryIndexOnce) {
  for (const std::size_t count : {0U, 1U, 15U, 16U, 17U, 1000U}) {
    std::vector<int> visits(count, 0);
    parallel_for(count, 16, [&](std::size_t i) { ++visits[i]; });
    EXPECT_EQ(std::accumulate(visits.begin(), visits.end(), 0), static_cast<int>(count));
    for (const int n : visits) ASSERT_EQ(n, 1);
  }
}

TEST(ParallelFor, PassesExceptionsOn) {
  const auto body = [](std::size_t i) {
    if (i == 777) throw std::runtime_error("index 777");
  };
  EXPECT_THROW(parallel_for(1000, 10, body), std::runtime_error);
  EXPECT_THROW(parallel_for(1000, 2000, body), std::runtime_error);
}

}  // namespace
}  // namespace gotai
