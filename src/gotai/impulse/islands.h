/// @file
/// Groups of bodies that touch: independent contact problems.
#pragma once

#include <vector>

#include "gotai/model/body_state.h"
#include "gotai/model/contact_set.h"

namespace gotai::impulse {

/// Dynamic bodies connected by contacts. Bodies that impulses do not move connect nothing.
struct Island {
  std::vector<model::BodyIndex> bodies;  ///< dynamic, ascending
  std::vector<std::uint32_t> pairs;      ///< indices into ContactSet::pairs, ascending
};

/// Islands in the order of their first pair. Pairs without a dynamic body are left out.
/// @param[out] islands  storage is reused
void find_islands(const model::BodyState& bodies, const model::ContactSet& contacts,
                  std::vector<Island>& islands);

}  // namespace gotai::impulse
