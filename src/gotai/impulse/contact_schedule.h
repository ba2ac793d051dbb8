/// @file
/// A fixed, parallel order of pairs for sequential-impulse sweeps.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gotai/impulse/disjoint_sets.h"
#include "gotai/model/body_state.h"
#include "gotai/model/contact_set.h"

namespace gotai::impulse {

/// Islands, by how often they have to be swept.
enum class IslandKind : std::uint8_t {
  stack,  ///< bodies on bodies, few contacts
  lone,   ///< one body that moves
  pile,   ///< all others
};
inline constexpr std::size_t kIslandKinds = 3;

/// Pairs in waves: no dynamic body occurs twice in a wave. For every body of a stack the waves
/// visit its pairs in top-down order, so that a sweep over waves gives the same bits as the
/// sequential top-down sweep. Waves are of one kind of island.
struct ContactSchedule {
  std::vector<std::uint32_t> pair;        ///< indices into ContactSet::pairs, wave by wave
  std::vector<std::uint32_t> wave_begin;  ///< number of waves + 1 offsets into pair
  /// Waves of kind k are [kind_begin[k], kind_begin[k + 1]).
  std::array<std::uint32_t, kIslandKinds + 1> kind_begin{};

  std::size_t waves() const { return wave_begin.empty() ? 0 : wave_begin.size() - 1; }
};

/// Orders pairs from the top of every stack down to its support: a body's height is its distance in
/// contacts from bodies that do not move, and pairs come in descending height, ties by index.
/// Top-down because impulses then meet their support last; bottom-up sweeps were seen to gain
/// energy.
///
/// The way down a pile is long and has few pairs side by side. There, every pair in that order
/// takes the first wave in which its bodies are free [greedy colouring]: as many waves as bodies
/// have neighbours, wide enough for lanes and threads; piles rest no worse. Pairs of a wave are
/// sorted by their number of contacts, so that the lanes of a batch are equally long.
class ContactScheduler {
 public:
  /// @param largest_stack  an island of at most this many contacts, in which bodies rest on bodies
  ///                       that move, is a stack
  const ContactSchedule& build(const model::BodyState& bodies, const model::ContactSet& contacts,
                               std::uint32_t largest_stack);

 private:
  void measure_heights(const model::BodyState& bodies, const model::ContactSet& contacts);
  void measure_islands(const model::BodyState& bodies, const model::ContactSet& contacts);
  void sort_top_down(const model::ContactSet& contacts);
  /// The first wave after those of the bodies' earlier pairs.
  std::uint32_t following_wave(const model::BodyState& bodies, const model::ContactPair& pair);
  /// The first wave without the bodies' earlier pairs.
  std::uint32_t free_wave(const model::BodyState& bodies, const model::ContactPair& pair);
  void assign_waves(const model::BodyState& bodies, const model::ContactSet& contacts,
                    std::uint32_t largest_stack);
  /// Stable counting sort of order_. @param key  of a pair, < buckets
  template <typename Key>
  void sort_order(std::uint32_t buckets, const Key& key);

  ContactSchedule schedule_;
  DisjointSets islands_{0};
  // Per body that is the least of an island:
  std::vector<std::uint32_t> island_size_;     // contacts
  std::vector<bool> is_linked_;                // do bodies that move touch each other?
  std::vector<std::uint32_t> height_;          // per body
  std::uint32_t highest_ = 0;                  // of bodies that have support
  std::vector<std::uint32_t> neighbor_begin_;  // CSR adjacency of the contact graph
  std::vector<std::uint32_t> neighbor_;
  std::vector<std::uint32_t> queue_;
  std::vector<std::uint32_t> order_;         // pairs
  std::vector<std::uint32_t> sorted_;        // storage of sort_order()
  std::vector<std::uint32_t> bucket_begin_;  // storage of sort_order()
  std::vector<std::uint32_t> next_wave_;     // per body
  std::vector<std::uint64_t> waves_used_;    // per body, bit by bit
  std::vector<std::uint32_t> wave_of_;       // per pair
};

}  // namespace gotai::impulse
