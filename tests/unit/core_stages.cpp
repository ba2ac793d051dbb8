// Stages: every item once, after all items that its stage waits for, on any number of threads.
#include "gotai/core/stages.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <stdexcept>
#include <string>

#include "gotai/core/parallel.h"

namespace gotai {
namespace {

constexpr int kStages = 400;
constexpr std::uint32_t kItems = 44 * 36 + 6;

// Stages of 0 to 8 items; every third needs only what the one before it needed.
std::vector<Stage<int>> many_stages() {
  std::vector<Stage<int>> stages;
  stages.reserve(kStages);
  for (int s = 0; s < kStages; ++s) {
    stages.push_back(
        {s, static_cast<std::uint32_t>(10 * s), static_cast<std::uint32_t>(s % 9), s % 3 != 2});
  }
  return stages;
}

// Calls what so that it may use as many threads, also if the machine has fewer processors.
template <typename What>
void on_threads(int threads, const What& what) {
  const ThreadLimit limit(threads);
  tbb::task_arena arena(threads);
  arena.execute([&] {
    ASSERT_EQ(thread_count(), static_cast<std::size_t>(threads));
    what();
  });
}

TEST(Stages, EveryItemOnceAndAfterTheStagesBefore) {
  const std::vector<Stage<int>> stages = many_stages();
  for (const int threads : {1, 2, 4, 12})
    on_threads(threads, [&] {
      const ThreadTeam team;
      for (int repeat = 0; repeat < 20; ++repeat) {
        std::vector<std::atomic<std::uint32_t>> visits(std::size_t{10} * kStages);
        std::vector<std::atomic<std::uint32_t>> finished(kStages);
        std::atomic<int> early{0};
        run_stages(stages, 1, [&](int stage, std::uint32_t first, std::uint32_t count) {
          const int before = stages[static_cast<std::size_t>(stage)].waits ? stage - 1 : stage - 2;
          if (before >= 0 && finished[static_cast<std::size_t>(before)] !=
                                 stages[static_cast<std::size_t>(before)].count)
            ++early;
          for (std::uint32_t k = first; k < first + count; ++k) ++visits[k];
          finished[static_cast<std::size_t>(stage)] += count;
        });
        EXPECT_EQ(early, 0) << threads;
        for (const Stage<int>& stage : stages)
          for (std::uint32_t k = 0; k < 10; ++k)
            ASSERT_EQ(visits[stage.first + k], k < stage.count ? 1U : 0U) << threads;
      }
    });
}

TEST(Stages, WorkWithoutATeamAndInsideOfSharedWork) {
  const std::vector<Stage<int>> stages = many_stages();
  const auto count_items = [&] {
    std::atomic<std::uint32_t> items{0};
    run_stages(stages, 1, [&](int, std::uint32_t, std::uint32_t count) { items += count; });
    return items.load();
  };
  on_threads(4, [&] {
    EXPECT_EQ(count_items(), kItems);
    ThreadTeam team;
    std::atomic<int> wrong{0};
    for (int repeat = 0; repeat < 20; ++repeat)
      team.share([&](std::size_t) { wrong += count_items() == kItems ? 0 : 1; });
    EXPECT_EQ(wrong, 0);
  });
}

// Those of others are done, too, when a thread never comes: no helper enters a team of one.
TEST(Stages, OneThreadDoesWhatBelongsToThoseThatStayAway) {
  const std::vector<Stage<int>> stages = many_stages();
  std::vector<int> visits(std::size_t{10} * kStages);
  const auto work = [&](int, std::uint32_t first, std::uint32_t count) {
    for (std::uint32_t k = first; k < first + count; ++k) ++visits[k];
  };
  StageRun<int, decltype(work)> run(stages, 5, work);
  run.take_part(2);
  for (const Stage<int>& stage : stages)
    for (std::uint32_t k = 0; k < 10; ++k) ASSERT_EQ(visits[stage.first + k], k < stage.count);
}

TEST(Stages, PassExceptionsOnAndCanBeRunAgain) {
  const std::vector<Stage<int>> stages = many_stages();
  for (const int threads : {1, 2, 4})
    on_threads(threads, [&] {
      const ThreadTeam team;
      for (const int bad : {1, 200, kStages - 1}) {
        EXPECT_THROW(run_stages(stages, 1,
                                [&](int stage, std::uint32_t, std::uint32_t) {
                                  if (stage == bad) throw std::runtime_error(std::to_string(bad));
                                }),
                     std::runtime_error);
      }
      std::atomic<std::uint32_t> items{0};
      run_stages(stages, 1, [&](int, std::uint32_t, std::uint32_t count) { items += count; });
      EXPECT_EQ(items, kItems) << threads;
    });
}

TEST(ThreadTeam, SharesWorkAmongItsThreadsAndReturnsWhenAllAreDone) {
  for (const int threads : {1, 2, 4})
    on_threads(threads, [&] {
      ThreadTeam team;
      EXPECT_EQ(team.size(), static_cast<std::size_t>(threads));
      EXPECT_EQ(ThreadTeam::current(), &team);
      for (int repeat = 0; repeat < 2000; ++repeat) {
        std::vector<int> calls(team.size(), 0);  // each by one thread: no two calls have a number
        team.share([&](std::size_t k) { ++calls.at(k); });
        EXPECT_EQ(calls[0], 1);
        for (const int n : calls) ASSERT_LE(n, 1);
      }
    });
  EXPECT_EQ(ThreadTeam::current(), nullptr);
}

TEST(ThreadTeam, TeamsAreNestedLikeScopes) {
  const ThreadLimit limit(2);
  ThreadTeam outer;
  {
    ThreadTeam inner;
    EXPECT_EQ(ThreadTeam::current(), &inner);
    std::atomic<int> calls{0};
    inner.share([&](std::size_t) {
      const ThreadTeam within;
      EXPECT_EQ(within.size(), 1U);
      EXPECT_TRUE(ThreadTeam::is_working());
      ++calls;
    });
    EXPECT_GE(calls, 1);
  }
  EXPECT_EQ(ThreadTeam::current(), &outer);
  EXPECT_FALSE(ThreadTeam::is_working());
}

TEST(ThreadTeam, PassesExceptionsOfItsOwnerOnAndWorksAgain) {
  const ThreadLimit limit(2);
  ThreadTeam team;
  const auto fail = [](std::size_t k) {
    if (k == 0) throw std::runtime_error("thread 0");
  };
  EXPECT_THROW(team.share(fail), std::runtime_error);
  std::atomic<int> calls{0};
  team.share([&](std::size_t) { ++calls; });
  EXPECT_GE(calls, 1);
}

}  // namespace
}  // namespace gotai
