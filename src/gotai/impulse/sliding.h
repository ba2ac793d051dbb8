/// @file
/// Pairs that slide: where friction acts on them.
#pragma once

#include <span>

#include "gotai/model/body_state.h"
#include "gotai/model/contact_set.h"

namespace gotai::impulse {

/// Does any contact of the pair slip faster than friction could stop within the step?
/// @param stopping_speed  |g| dt [m/s]
bool is_sliding(const model::BodyState& bodies, const model::ContactSet& contacts,
                const model::ContactPair& pair, double stopping_speed);

/// What the set says of where friction acts on a pair that slides; empty where contacts stand for
/// themselves.
std::span<const model::SlidingShare> sliding_shares(const model::ContactSet& contacts,
                                                    const model::ContactPair& pair);

}  // namespace gotai::impulse
