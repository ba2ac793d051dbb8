/// @file
/// How far bodies overlap before anything moves, whichever way their surfaces face.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "gotai/collision/broad_phase.h"
#include "gotai/model/body_state.h"
#include "gotai/model/settings.h"
#include "gotai/voxel/shape.h"

namespace gotai::collision {

/// Two bodies that overlap.
struct PairOverlap {
  BodyPair pair;
  double depth = 0.0;  ///< of the deepest contact or sample of a surface [m], > 0
};

/// All overlapping pairs by the collision model, ascending. With surface contacts, bodies that are
/// in each other by more than half have no contacts, for none could say which way out is: there the
/// deepest sample of one surface inside the other body counts.
/// @param shapes  indexed by BodyState::shape
/// @throws InvalidArgument as find_contacts
std::vector<PairOverlap> find_overlaps(const model::BodyState& bodies,
                                       std::span<const std::shared_ptr<const voxel::Shape>> shapes,
                                       const model::CollisionSettings& settings);

}  // namespace gotai::collision
