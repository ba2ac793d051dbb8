// Waves of pairs.
#include "gotai/impulse/contact_schedule.h"

#include <gtest/gtest.h>

#include <array>

namespace gotai::impulse {
namespace {

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

// In a pile, pairs take the first wave that their bodies are free in: as many waves as the body
// with the most neighbours has, not as many as the longest way down.
TEST(ContactSchedule, PilesHaveFewWavesInWhichNoBodyOccursTwice) {
  constexpr model::BodyIndex kRow = 200;
  constexpr model::BodyIndex kAround = 70;  // neighbours of the last body of the row
  model::BodyState bodies;
  for (model::BodyIndex i = 0; i < 1 + kRow + kAround; ++i) {
    model::append_body(bodies);
    if (i > 0) model::set_mass(bodies, i, 1.0, Mat3::Identity());
  }
  model::ContactSet contacts;
  const auto touch = [&](model::BodyIndex a, model::BodyIndex b) {
    const auto begin = static_cast<std::uint32_t>(contacts.size());
    contacts.resize(begin + 1);
    contacts.pairs.push_back({a, b, begin, begin + 1});
  };
  touch(1, 0);
  for (model::BodyIndex i = 1; i < kRow; ++i) touch(i, i + 1);
  ContactScheduler scheduler;
  EXPECT_EQ(scheduler.build(bodies, contacts, 1000).waves(), kRow);  // a stack goes top down
  EXPECT_EQ(scheduler.build(bodies, contacts, 1).waves(), 2U);
  for (model::BodyIndex i = 0; i < kAround; ++i) touch(kRow, kRow + 1 + i);
  const ContactSchedule& schedule = scheduler.build(bodies, contacts, 1);
  EXPECT_EQ(schedule.waves(), kAround + 1);
  std::vector<int> visits(contacts.pairs.size());
  for (std::size_t w = 0; w < schedule.waves(); ++w) {
    std::vector<int> uses(bodies.size());
    for (std::uint32_t k = schedule.wave_begin[w]; k < schedule.wave_begin[w + 1]; ++k) {
      const model::ContactPair& pair = contacts.pairs[schedule.pair[k]];
      ++visits[schedule.pair[k]];
      ++uses[pair.body_a];
      ++uses[pair.body_b];
    }
    for (model::BodyIndex i = 1; i < bodies.size(); ++i) ASSERT_LE(uses[i], 1) << w;
  }
  EXPECT_EQ(visits, std::vector<int>(contacts.pairs.size(), 1));
}

}  // namespace
}  // namespace gotai::impulse
