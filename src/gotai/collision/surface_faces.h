/// @file
/// Samples of a body above planes and the faces of containers, in the model `surface`.
#pragma once

#include <memory>
#include <span>

#include "gotai/collision/pair_motion.h"
#include "gotai/collision/surface_contacts.h"

namespace gotai::collision {

/// Appends to scratch.candidates the samples of body_a, a shape, above the faces of body_b, a plane
/// or a container, whose contacts may close within the step.
/// @param shapes  indexed by BodyState::shape, with surface models
/// @param margin  largest gap [m]
void append_face_contacts(const model::BodyState& bodies, const BodyPair& pair,
                          std::span<const std::shared_ptr<const voxel::Shape>> shapes,
                          ExactSurfaces exact, double margin, const PairMotion& motion,
                          SurfaceScratch& scratch);

}  // namespace gotai::collision
