/// @file
/// Contacts of two bodies in the model `surface`: the samples of each in the distance field of the
/// other, or above planes and the faces of containers.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "gotai/collision/broad_phase.h"
#include "gotai/collision/exact_surface.h"
#include "gotai/collision/near_samples.h"
#include "gotai/collision/reduction.h"
#include "gotai/collision/search_options.h"
#include "gotai/collision/surface_search.h"
#include "gotai/model/body_state.h"
#include "gotai/model/contact_set.h"
#include "gotai/voxel/shape.h"

namespace gotai::collision {

/// Key of a contact: which of the two bodies the sample is on (0: body_a, 1: body_b), or for planes
/// and containers which face it meets (floor 0, walls 1..4), and the sample.
constexpr model::FeatureKey surface_feature(std::uint32_t direction, std::uint32_t sample) {
  return static_cast<model::FeatureKey>(direction) << 32U | sample;
}

/// What the last search of a pair leaves for the next.
struct NearPair {
  /// The samples of body a in the field of body b, and the other way round.
  std::array<NearSamples, 2> way;
  bool apart = false;  ///< neither had hits
  Pose X_BA;           ///< of body a against body b then

  void forget() {
    for (NearSamples& near : way) near.forget();
    apart = false;
  }
};

/// Storage of the search for one pair after another.
struct SurfaceScratch {
  SurfaceSearch search;
  std::vector<ContactCandidate> candidates;
  Reduction reduction;
  double reduction_error = 0.0;  ///< largest Reduction::error so far
};

/// Exact distances to the surfaces of shapes, by BodyState::shape. Null where the shape's surface
/// is not closed or overlaps itself: its field is all there is.
using ExactSurfaces = std::span<const std::unique_ptr<const ExactSurface>>;

/// Appends the contacts of one pair with a gap up to the margin; body_a has a shape, body_b a
/// shape, a plane or a container. Contacts that cannot close within options.dt are left out. With
/// options.contacts = reduced few remain, which stand for the others' areas, and gaps that may
/// carry are measured to the triangles: in a step (options.dt > 0) of every such sample where it
/// is, so that gaps do not jump; else near edges, which a field rounds, with samples of edges
/// sliding along theirs to where it is nearest.
/// @param shapes  indexed by BodyState::shape, with surface models
/// @param exact   likewise; empty: gaps are the fields'
/// @param margin  [m], >= 0
/// @param near    of the pair's last search with these shapes, or empty: changes no bit of the
///                result. Null: nothing is kept
/// @param anchor  of the pair, for `reduced` in a step: while the pair is near it, its contacts are
///                taken from there, otherwise it is set anew; without contacts: nothing is known.
///                Null: contacts are those of the present poses
void append_surface_contacts(const model::BodyState& bodies, const BodyPair& pair,
                             std::span<const std::shared_ptr<const voxel::Shape>> shapes,
                             ExactSurfaces exact, double margin, const SearchOptions& options,
                             SurfaceScratch& scratch, model::ContactSet& out,
                             NearPair* near = nullptr,
                             model::ContactAnchors::Pair* anchor = nullptr);

}  // namespace gotai::collision
