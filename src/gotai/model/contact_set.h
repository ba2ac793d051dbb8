/// @file
/// Contacts of one step, as found by a collision model and read by an impulse method.
#pragma once

#include <cstdint>
#include <vector>

#include "gotai/core/types.h"
#include "gotai/model/body_state.h"

namespace gotai::model {

/// Stable name of a contact from step to step: within a pair, which sample or voxels touch.
using FeatureKey = std::uint64_t;

/// Two bodies and their contacts [begin, end) in a ContactSet. When only one of them is dynamic it
/// is body_a; otherwise body_a < body_b. Pairs are sorted by (body_a, body_b).
struct ContactPair {
  BodyIndex body_a = 0;
  BodyIndex body_b = 0;
  std::uint32_t begin = 0;
  std::uint32_t end = 0;

  std::uint32_t size() const { return end - begin; }
};

/// Friction of a share of a flat patch that slides under even pressure. The resultant of friction
/// that opposes the slip of every part of it acts at one point, which slips in the resultant's
/// direction, and is smaller than if all parts slipped the same way [Contensou 1963, "Couplage
/// entre frottement de glissement et frottement de pivotement dans la theorie de la toupie"].
struct SlidingShare {
  std::uint32_t contact = 0;     ///< that stands for the share
  double area = 0.0;             ///< of the share [m^2], > 0
  double alignment = 1.0;        ///< length of the mean direction of slip, in [0, 1]
  Vec3 centre_W = Vec3::Zero();  ///< of the share [m], W
  Vec3 point_W = Vec3::Zero();   ///< where the resultant acts [m], W
};

/// Structure of arrays, grouped by pair, within a pair sorted by feature. Written by collision.
struct ContactSet {
  std::vector<ContactPair> pairs;

  std::vector<Vec3> point_W;        ///< where they touch [m], W
  std::vector<Vec3> normal_W;       ///< unit, from b to a, W
  std::vector<double> gap;          ///< distance along the normal [m]; < 0 is overlap
  std::vector<Vec3> anchor_A;       ///< the point on a, in a's body frame [m]
  std::vector<Vec3> anchor_B;       ///< the point on b, in b's body frame [m];
                                    ///< gap = normal . (x_A(anchor) - x_B(anchor)) when found
  std::vector<Vec3> friction_W;     ///< where friction acts: the centre of the surface that the
                                    ///< contact stands for [m], W; point_W unless reduced
  std::vector<double> area;         ///< surface that the contact stands for [m^2]; spheres: 1
  std::vector<FeatureKey> feature;  ///< stable key within the pair
  /// Of reduced contacts whose pair was searched as it moved, ascending by contact; none for
  /// others.
  std::vector<SlidingShare> sliding;

  std::size_t size() const { return gap.size(); }
  /// Empties it; storage is kept.
  void clear();
  /// Changes the number of contacts (not the pairs); whoever asks for more writes the new ones.
  void resize(std::size_t count);
  /// Appends one contact to the last pair. Friction acts at its point.
  void push(const Vec3& point, const Vec3& normal, double gap_m, const Vec3& a, const Vec3& b,
            double area_m2, FeatureKey key);
};

/// Gaps at the present poses: normal . (anchor on a - anchor on b), with the normals as found [m].
/// @param[out] gap  one per contact; storage is reused
void refresh_gaps(const BodyState& bodies, const ContactSet& contacts, std::vector<double>& gap);

/// Checks order, ranges, unit normals.
/// @throws SimulationError naming pair and contact
void validate(const ContactSet& contacts, std::size_t body_count);

}  // namespace gotai::model
