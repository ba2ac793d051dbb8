/// @file
/// A fixed, parallel order of pairs for sequential-impulse sweeps.
#pragma once

#include <cstdint>
#include <vector>

#include "gotai/model/body_state.h"
#include "gotai/model/contact_set.h"

namespace gotai::impulse {

/// Pairs in waves: no dynamic body occurs twice in a wave, and for every body the waves visit its
/// pairs in top-down order, so a sweep over waves gives the same bits as the sequential top-down
/// sweep.
struct ContactSchedule {
  std::vector<std::uint32_t> pair;        ///< indices into ContactSet::pairs, wave by wave
  std::vector<std::uint32_t> wave_begin;  ///< number of waves + 1 offsets into pair

  std::size_t waves() const { return wave_begin.empty() ? 0 : wave_begin.size() - 1; }
};

/// Orders pairs from the top of every pile down to its support: a body's height is its distance in
/// contacts from bodies that do not move, and pairs come in descending height, ties by index.
/// Top-down because impulses then meet their support last; bottom-up sweeps were seen to gain
/// energy.
/// @param counts  contacts per pair that will be solved; pairs of a wave are sorted by it, so that
/// lanes
///                of a batch are equally long
class ContactScheduler {
 public:
  const ContactSchedule& build(const model::BodyState& bodies, const model::ContactSet& contacts,
                               const std::vector<std::uint32_t>& counts);

 private:
  void measure_heights(const model::BodyState& bodies, const model::ContactSet& contacts);

  ContactSchedule schedule_;
  std::vector<std::uint32_t> height_;          // per body
  std::vector<std::uint32_t> neighbor_begin_;  // CSR adjacency of the contact graph
  std::vector<std::uint32_t> neighbor_;
  std::vector<std::uint32_t> queue_;
  std::vector<std::uint32_t> order_;      // pairs, top-down
  std::vector<std::uint32_t> next_wave_;  // per body
  std::vector<std::uint32_t> wave_of_;    // per pair
};

}  // namespace gotai::impulse
