// Stages of a sweep: every item once, after all items of the stages before; waves of pairs.
#include "gotai/impulse/stages.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>

#include "gotai/impulse/contact_schedule.h"

namespace gotai::impulse {
namespace {

TEST(Stages, EveryItemOnceAndAfterTheStagesBefore) {
  constexpr int kStages = 400;
  std::vector<Stage<int>> stages;
  stages.reserve(kStages);
  for (int s = 0; s < kStages; ++s)
    stages.push_back({s, static_cast<std::uint32_t>(10 * s), static_cast<std::uint32_t>(s % 9)});
  for (const int threads : {1, 2, 4}) {
    const ThreadLimit limit(threads);
    std::vector<std::atomic<std::uint32_t>> visits(std::size_t{10} * kStages);
    std::vector<std::atomic<std::uint32_t>> finished(kStages);
    std::atomic<int> early{0};
    run_stages(stages, 1, [&](int stage, std::uint32_t first, std::uint32_t count) {
      if (stage > 0 && finished[static_cast<std::size_t>(stage - 1)] !=
                           stages[static_cast<std::size_t>(stage - 1)].count)
        ++early;
      for (std::uint32_t k = first; k < first + count; ++k) ++visits[k];
      finished[static_cast<std::size_t>(stage)] += count;
    });
    EXPECT_EQ(early, 0) << threads;
    for (const Stage<int>& stage : stages)
      for (std::uint32_t k = 0; k < 10; ++k)
        ASSERT_EQ(visits[stage.first + k], k < stage.count ? 1U : 0U) << threads;
  }
}

// A fixed floor 0, a stack 1-2-3 on it, a lone body 4, and two bodies 5-6 with many contacts.
TEST(ContactSchedule, WavesGoTopDownAndAreOfOneKindOfIsland) {
  model::BodyState bodies;
  for (model::BodyIndex i = 0; i < 7; ++i) {
    model::append_body(bodies);
    if (i > 0) model::set_mass(bodies, i, 1.0, Mat3::Identity());
  }
  model::ContactSet contacts;
  const auto touch = [&](model::BodyIndex a, model::BodyIndex b, std::uint32_t count) {
    const auto begin = static_cast<std::uint32_t>(contacts.size());
    contacts.resize(begin + count);
    contacts.pairs.push_back({a, b, begin, begin + count});
  };
  touch(1, 0, 4);
  touch(1, 2, 3);
  touch(2, 3, 4);
  touch(4, 0, 4);
  touch(5, 0, 10);
  touch(5, 6, 10);
  ContactScheduler scheduler;
  const ContactSchedule& schedule = scheduler.build(bodies, contacts, 19);
  EXPECT_EQ(schedule.pair, (std::vector<std::uint32_t>{2, 1, 0, 3, 5, 4}));
  EXPECT_EQ(schedule.wave_begin, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(schedule.kind_begin, (std::array<std::uint32_t, 4>{0, 3, 4, 6}));
}

}  // namespace
}  // namespace gotai::impulse
