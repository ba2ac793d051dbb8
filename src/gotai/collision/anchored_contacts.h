/// @file
/// Contacts that move with their bodies while a pair hardly moves, instead of being searched again.
#pragma once

#include "gotai/collision/broad_phase.h"
#include "gotai/collision/pair_motion.h"
#include "gotai/model/body_state.h"
#include "gotai/model/contact_anchors.h"
#include "gotai/model/contact_set.h"

namespace gotai::collision {

/// Farthest that a pair may move against the pose in which its contacts were found, until the end
/// of the step [diameters of the smaller body]. As much as a deeper sample must be deeper by to
/// replace one that carried; piles come to rest with four times as much, too, with more contacts.
inline constexpr double kAnchorTolerance = 2e-4;

/// Does an anchor still stand for the contacts of its pair up to `reach` [m] in this step? Then no
/// point that was farther than the anchor's reach has come within this one.
bool is_near_anchor(const model::ContactAnchors::Pair& anchor, const model::BodyState& bodies,
                    const PairMotion& motion, double reach);

/// Writes an anchor's contacts at the present poses to their place [begin, ...) in a set that is
/// large enough: points move with their bodies, normals turn with body b, gaps change along the
/// normals, as solvers take them to do within a step.
void write_anchored(const model::ContactAnchors::Pair& anchor, const model::BodyState& bodies,
                    std::size_t begin, model::ContactSet& out);

}  // namespace gotai::collision
