/// @file
/// Contacts of two bodies in the model `spheres`: voxel spheres against voxel spheres, planes and
/// containers [Makino 2007, section 3.2.3; contact point and normal: erratum 15].
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gotai/collision/broad_phase.h"
#include "gotai/collision/sphere_descent.h"
#include "gotai/model/body_state.h"
#include "gotai/model/contact_set.h"

namespace gotai::collision {

/// Working storage of one thread. Not state.
struct SphereScratch {
  DescentScratch descent;
  std::vector<SphereOverlap> overlaps;
  std::vector<std::uint32_t> voxels;       // of one body, that reach a plane
  std::vector<std::uint32_t> next_voxels;  // likewise, of the next level
};

/// Appends the contacts of one pair, if there are any, as a new pair of the set.
///
/// * Two shapes: n = (c_A - c_B) / |c_A - c_B|; the point lies on the line of centres, c_B +
///   r_B / (r_A + r_B) (c_A - c_B); gap = |c_A - c_B| - (r_A + r_B). For coincident centres n is
///   the direction between the centres of mass, and +z when these coincide too.
///   Feature: voxel of a << 32 | voxel of b (indices in the level).
/// * Shape on plane (always body b): n = the plane's normal, the point is the lowest of the sphere,
///   gap = height of the centre - r_A. Feature: voxel of a.
/// * Shape in container (always body b): floor and four walls, each as a plane that faces inwards.
///   Faces are one-sided and have no thickness: they act on a sphere only when its centre, or its
///   body's centre of mass, is above the floor's area; walls only when the sphere's centre is below
///   the rim. So a body that has left the container falls freely, and nothing acts on what stands
///   outside next to a wall. Feature: face << 32 | voxel of a, with faces 0 floor, 1 -x, 2 +x,
///   3 -y, 4 +y.
///
/// Every contact has area 1. Anchors are the two surface points on the line of the normal, so that
/// gap = n . (x_A(anchor_A) - x_B(anchor_B)).
/// @param trees   indexed by BodyState::shape
/// @param level   k
/// @param margin  contacts are found up to this gap [m]
/// @param[in,out] tests  increased by the tests done
void append_sphere_contacts(const model::BodyState& bodies, const BodyPair& pair,
                            std::span<const SphereTree> trees, int level, double margin,
                            SphereScratch& scratch, model::ContactSet& out, TestCounts& tests);

}  // namespace gotai::collision
