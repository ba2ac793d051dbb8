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
#include "gotai/collision/field_contacts.h"
#include "gotai/collision/near_samples.h"
#include "gotai/collision/search_options.h"
#include "gotai/model/body_state.h"
#include "gotai/model/contact_set.h"
#include "gotai/voxel/shape.h"

namespace gotai::collision {

/// What the last search of a pair leaves for the next.
struct NearPair {
  // First what is asked of every pair in every step.
  /// While no sample has moved farther than d since, no gap is below clearance - d, as long as that
  /// is at most `clear_up_to` [m]; < 0: not known.
  double clearance = -1.0;
  double clear_up_to = 0.0;
  bool apart = false;   ///< neither way had hits
  bool distant = true;  ///< the next search is probably without hits, and not near them
  Pose X_BA;            ///< of body a against body b when `apart` or `clearance` were found
  /// The samples of body a in the field of body b, and the other way round.
  std::array<NearSamples, 2> way;

  void forget() {
    for (NearSamples& near : way) near.forget();
    apart = false;
    distant = true;
    clearance = -1.0;
  }
};

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
void append_surface_contacts(const model::BodyState& bodies, const BodyPair& pair,
                             std::span<const std::shared_ptr<const voxel::Shape>> shapes,
                             ExactSurfaces exact, double margin, const SearchOptions& options,
                             SurfaceScratch& scratch, model::ContactSet& out,
                             NearPair* near = nullptr);

/// The same for `reduced` in a step, with contacts that stay while the pair hardly moves: while it
/// is near its anchor nothing is searched, otherwise the anchor is set anew.
/// @param anchor  of the pair; without contacts: nothing is known, or the bodies are apart
/// @param[in,out] sliding  appended to when a pair that slides is searched; contacts are counted
///                         within the pair
void refresh_anchor(const model::BodyState& bodies,
                    std::span<const std::shared_ptr<const voxel::Shape>> shapes,
                    ExactSurfaces exact, double margin, const SearchOptions& options,
                    SurfaceScratch& scratch, NearPair* near, model::ContactAnchors::Pair& anchor,
                    std::vector<model::SlidingShare>& sliding);

}  // namespace gotai::collision
