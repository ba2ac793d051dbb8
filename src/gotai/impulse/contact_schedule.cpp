#include "gotai/impulse/contact_schedule.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "gotai/core/parallel.h"

namespace gotai::impulse {
namespace {
constexpr std::uint32_t kUnsupported = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint32_t kCountedWaves = 64;  // bits of waves_used_
}  // namespace

void ContactScheduler::measure_heights(const model::BodyState& bodies,
                                       const model::ContactSet& contacts) {
  const std::size_t count = bodies.size();
  neighbor_begin_.assign(count + 1, 0);
  for (const model::ContactPair& pair : contacts.pairs) {
    ++neighbor_begin_[pair.body_a + 1];
    ++neighbor_begin_[pair.body_b + 1];
  }
  for (std::size_t i = 0; i < count; ++i) neighbor_begin_[i + 1] += neighbor_begin_[i];
  neighbor_.resize(2 * contacts.pairs.size());
  next_wave_.assign(neighbor_begin_.begin(), neighbor_begin_.end() - 1);  // fill positions
  for (const model::ContactPair& pair : contacts.pairs) {
    neighbor_[next_wave_[pair.body_a]++] = pair.body_b;
    neighbor_[next_wave_[pair.body_b]++] = pair.body_a;
  }

  height_.assign(count, kUnsupported);
  highest_ = 0;
  queue_.clear();
  for (model::BodyIndex i = 0; i < count; ++i) {
    if (bodies.is_dynamic(i)) continue;
    height_[i] = 0;
    queue_.push_back(i);
  }
  for (std::size_t head = 0; head < queue_.size(); ++head) {
    const std::uint32_t i = queue_[head];
    highest_ = height_[i];
    for (std::uint32_t k = neighbor_begin_[i]; k < neighbor_begin_[i + 1]; ++k) {
      const std::uint32_t j = neighbor_[k];
      if (height_[j] != kUnsupported) continue;
      height_[j] = height_[i] + 1;
      queue_.push_back(j);
    }
  }
}

void ContactScheduler::measure_islands(const model::BodyState& bodies,
                                       const model::ContactSet& contacts) {
  islands_.reset(bodies.size());
  for (const model::ContactPair& pair : contacts.pairs) {
    if (bodies.is_dynamic(pair.body_a) && bodies.is_dynamic(pair.body_b))
      islands_.join(pair.body_a, pair.body_b);
  }
  island_size_.assign(bodies.size(), 0);
  is_linked_.assign(bodies.size(), false);
  for (const model::ContactPair& pair : contacts.pairs) {
    const std::uint32_t island = islands_.least(pair.body_a);
    island_size_[island] += pair.size();
    if (bodies.is_dynamic(pair.body_b)) is_linked_[island] = true;
  }
}

template <typename Key>
void ContactScheduler::sort_order(std::uint32_t buckets, const Key& key) {
  bucket_begin_.assign(buckets + 1, 0);
  for (const std::uint32_t p : order_) ++bucket_begin_[key(p) + 1];
  for (std::uint32_t k = 0; k < buckets; ++k) bucket_begin_[k + 1] += bucket_begin_[k];
  sorted_.resize(order_.size());
  for (const std::uint32_t p : order_) sorted_[bucket_begin_[key(p)]++] = p;
  order_.swap(sorted_);
}

void ContactScheduler::sort_top_down(const model::ContactSet& contacts) {
  // Floating bodies are above all others.
  const auto depth = [&](model::BodyIndex i) {
    return height_[i] == kUnsupported ? 0U : highest_ + 1 - height_[i];
  };
  sort_order(highest_ + 2, [&](std::uint32_t p) {
    return std::max(depth(contacts.pairs[p].body_a), depth(contacts.pairs[p].body_b));
  });
  sort_order(highest_ + 2, [&](std::uint32_t p) {
    return std::min(depth(contacts.pairs[p].body_a), depth(contacts.pairs[p].body_b));
  });
}

std::uint32_t ContactScheduler::following_wave(const model::BodyState& bodies,
                                               const model::ContactPair& pair) {
  std::uint32_t wave = 0;
  for (const model::BodyIndex i : {pair.body_a, pair.body_b})
    if (bodies.is_dynamic(i)) wave = std::max(wave, next_wave_[i]);
  for (const model::BodyIndex i : {pair.body_a, pair.body_b})
    if (bodies.is_dynamic(i)) next_wave_[i] = wave + 1;
  return wave;
}

std::uint32_t ContactScheduler::free_wave(const model::BodyState& bodies,
                                          const model::ContactPair& pair) {
  std::uint64_t used = 0;
  for (const model::BodyIndex i : {pair.body_a, pair.body_b})
    if (bodies.is_dynamic(i)) used |= waves_used_[i];
  const auto wave = static_cast<std::uint32_t>(std::countr_one(used));
  // Bodies with very many neighbours: their other pairs follow each other.
  if (wave == kCountedWaves) return kCountedWaves + following_wave(bodies, pair);
  for (const model::BodyIndex i : {pair.body_a, pair.body_b})
    if (bodies.is_dynamic(i)) waves_used_[i] |= std::uint64_t{1} << wave;
  return wave;
}

void ContactScheduler::assign_waves(const model::BodyState& bodies,
                                    const model::ContactSet& contacts,
                                    std::uint32_t largest_stack) {
  const auto kind_of = [&](const model::ContactPair& pair) {
    const std::uint32_t island = islands_.least(pair.body_a);
    if (!is_linked_[island]) return IslandKind::lone;
    return island_size_[island] <= largest_stack ? IslandKind::stack : IslandKind::pile;
  };
  next_wave_.assign(bodies.size(), 0);
  waves_used_.assign(bodies.size(), 0);
  wave_of_.resize(order_.size());
  std::array<std::uint32_t, kIslandKinds> waves{};
  for (const std::uint32_t p : order_) {
    const model::ContactPair& pair = contacts.pairs[p];
    const IslandKind kind = kind_of(pair);
    const std::uint32_t wave =
        kind == IslandKind::pile ? free_wave(bodies, pair) : following_wave(bodies, pair);
    wave_of_[p] = wave;
    std::uint32_t& count = waves[static_cast<std::size_t>(kind)];
    count = std::max(count, wave + 1);
  }
  for (std::size_t k = 0; k < kIslandKinds; ++k)
    schedule_.kind_begin[k + 1] = schedule_.kind_begin[k] + waves[k];
  for (const std::uint32_t p : order_)
    wave_of_[p] += schedule_.kind_begin[static_cast<std::size_t>(kind_of(contacts.pairs[p]))];
  schedule_.wave_begin.assign(schedule_.kind_begin[kIslandKinds] + 1, 0);
}

const ContactSchedule& ContactScheduler::build(const model::BodyState& bodies,
                                               const model::ContactSet& contacts,
                                               std::uint32_t largest_stack) {
  const auto pair_count = static_cast<std::uint32_t>(contacts.pairs.size());
  const auto reset_order = [&] {
    order_.resize(pair_count);
    for (std::uint32_t p = 0; p < pair_count; ++p) order_[p] = p;
  };
  parallel_for(2, 1, [&](std::size_t task) {
    if (task == 0) {
      measure_heights(bodies, contacts);
      reset_order();
      sort_top_down(contacts);
    } else {
      measure_islands(bodies, contacts);
    }
  });
  assign_waves(bodies, contacts, largest_stack);

  reset_order();
  std::uint32_t longest = 0;
  for (const model::ContactPair& pair : contacts.pairs) longest = std::max(longest, pair.size());
  sort_order(longest + 1, [&](std::uint32_t p) { return longest - contacts.pairs[p].size(); });
  const auto waves = static_cast<std::uint32_t>(schedule_.waves());
  sort_order(waves, [&](std::uint32_t p) { return wave_of_[p]; });
  schedule_.pair = order_;
  for (const std::uint32_t p : order_) ++schedule_.wave_begin[wave_of_[p] + 1];
  for (std::uint32_t w = 0; w < waves; ++w) schedule_.wave_begin[w + 1] += schedule_.wave_begin[w];
  return schedule_;
}

}  // namespace gotai::impulse
