#include "gotai/impulse/contact_schedule.h"

#include <algorithm>
#include <limits>

namespace gotai::impulse {
namespace {
constexpr std::uint32_t kUnsupported = std::numeric_limits<std::uint32_t>::max();
}

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
  queue_.clear();
  for (model::BodyIndex i = 0; i < count; ++i) {
    if (bodies.is_dynamic(i)) continue;
    height_[i] = 0;
    queue_.push_back(i);
  }
  for (std::size_t head = 0; head < queue_.size(); ++head) {
    const std::uint32_t i = queue_[head];
    for (std::uint32_t k = neighbor_begin_[i]; k < neighbor_begin_[i + 1]; ++k) {
      const std::uint32_t j = neighbor_[k];
      if (height_[j] != kUnsupported) continue;
      height_[j] = height_[i] + 1;
      queue_.push_back(j);
    }
  }
}

const ContactSchedule& ContactScheduler::build(const model::BodyState& bodies,
                                               const model::ContactSet& contacts,
                                               const std::vector<std::uint32_t>& counts) {
  measure_heights(bodies, contacts);
  const auto pair_count = static_cast<std::uint32_t>(contacts.pairs.size());
  order_.resize(pair_count);
  for (std::uint32_t p = 0; p < pair_count; ++p) order_[p] = p;
  const auto height_of = [&](std::uint32_t p) {
    const model::ContactPair& pair = contacts.pairs[p];
    const std::uint32_t a = height_[pair.body_a];
    const std::uint32_t b = height_[pair.body_b];
    return std::pair(std::max(a, b), std::min(a, b));
  };
  std::stable_sort(order_.begin(), order_.end(),
                   [&](std::uint32_t p, std::uint32_t q) { return height_of(p) > height_of(q); });

  next_wave_.assign(bodies.size(), 0);
  wave_of_.resize(pair_count);
  std::uint32_t waves = 0;
  for (const std::uint32_t p : order_) {
    const model::ContactPair& pair = contacts.pairs[p];
    std::uint32_t wave = 0;
    for (const model::BodyIndex i : {pair.body_a, pair.body_b})
      if (bodies.is_dynamic(i)) wave = std::max(wave, next_wave_[i]);
    for (const model::BodyIndex i : {pair.body_a, pair.body_b})
      if (bodies.is_dynamic(i)) next_wave_[i] = wave + 1;
    wave_of_[p] = wave;
    waves = std::max(waves, wave + 1);
  }

  schedule_.pair = order_;
  std::sort(schedule_.pair.begin(), schedule_.pair.end(), [&](std::uint32_t p, std::uint32_t q) {
    if (wave_of_[p] != wave_of_[q]) return wave_of_[p] < wave_of_[q];
    return counts[p] != counts[q] ? counts[p] > counts[q] : p < q;
  });
  schedule_.wave_begin.assign(waves + 1, 0);
  for (const std::uint32_t p : schedule_.pair) ++schedule_.wave_begin[wave_of_[p] + 1];
  for (std::uint32_t w = 0; w < waves; ++w) schedule_.wave_begin[w + 1] += schedule_.wave_begin[w];
  return schedule_;
}

}  // namespace gotai::impulse
