#include "gotai/collision/field_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "gotai/collision/relative_pose.h"
#include "gotai/collision/surface_sample.h"

namespace gotai::collision {
namespace {

using model::BodyState;
using Shapes = std::span<const std::shared_ptr<const voxel::Shape>>;

// Packets farther than this hold impacts to come, not what bodies rest on [cells].
constexpr float kFarCells = 1.0F;

std::array<double, 9> by_rows(const Mat3& R) {
  return {R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)};
}

}  // namespace

FieldContacts::FieldContacts(const BodyState& bodies, const BodyPair& pair, Shapes shapes,
                             ExactSurfaces smooth, bool samples_of_b, const Pose& X_QP)
    : samples_of_b_(samples_of_b),
      p_MA_(bodies.p_MB[pair.body_a]),
      samples_(shapes[bodies.shape[samples_of_b ? pair.body_b : pair.body_a]]->surface),
      field_(shapes[bodies.shape[samples_of_b ? pair.body_a : pair.body_b]]->surface),
      X_QP_(X_QP),
      R_QP_(X_QP_.q.toRotationMatrix()),
      pose_(make_sample_pose(R_QP_, X_QP_ * samples_.center - field_.center)) {
  const std::uint32_t shape = bodies.shape[samples_of_b ? pair.body_b : pair.body_a];
  if (!smooth.empty() && smooth[shape] != nullptr) curved_ = &smooth[shape]->curved;
  is_exact_ =
      !smooth.empty() && smooth[bodies.shape[samples_of_b ? pair.body_a : pair.body_b]] != nullptr;
}

float FieldContacts::search_margin(double margin) {
  const auto rounded = static_cast<float>(margin);
  return static_cast<double>(rounded) > margin ? std::nextafter(rounded, 0.0F) : rounded;
}

void FieldContacts::append(const FieldReach& reach, const PairMotion& motion, NearSamples* near,
                           SurfaceScratch& scratch) const {
  const SearchReach searched = search_reach(reach, motion);
  if (near != nullptr) {
    search_field(samples_, field_.field, pose_, searched, motion.farthest(), *near, scratch.search);
  } else {
    search_field(samples_.tree, field_.field, pose_, searched, scratch.search);
  }
  append_hits(reach, motion, scratch);
}

double FieldContacts::append_if_near(const FieldReach& reach, double wide, const PairMotion& motion,
                                     SurfaceScratch& scratch) const {
  search_field_widely(samples_.tree, field_.field, pose_, search_reach(reach, motion),
                      static_cast<float>(wide), scratch.search);
  append_hits(reach, motion, scratch);
  return static_cast<double>(scratch.search.clearance);
}

// Of a packet none of whose samples may carry, the nearest stands for all: it lies within a few
// cells of them, and what comes near is searched again. Far packets are for bodies that fly: lists
// of near samples know nothing of them, and serve smaller margins only.
SearchReach FieldContacts::search_reach(const FieldReach& reach, const PairMotion& motion) const {
  const float margin = search_margin(reach.searched);
  if (!reach.reduced) return margin;
  const float far = kFarCells * field_.field.cell;
  return {margin, static_cast<float>(motion.rest_reach()),
          motion.in_step() && margin > far ? far : std::numeric_limits<float>::infinity(),
          beside_crossings(reach, motion)};
}

// Farther from a crossing of edges than this the next sample is nearer to it.
float FieldContacts::beside_crossings(const FieldReach& reach, const PairMotion& motion) const {
  if (!reach.reduced || !is_exact_) return 0.0F;
  return static_cast<float>(motion.rest_reach() + kEdgeShare * samples_.spacing);
}

void FieldContacts::append_hits(const FieldReach& reach, const PairMotion& motion,
                                SurfaceScratch& scratch) const {
  if (scratch.search.hits.empty()) return;
  const Vec3 origin_A = (samples_of_b_ ? X_QP_ * samples_.center : samples_.center) - p_MA_;
  const NearSurface surface{samples_,
                            field_.field,
                            curved_,
                            pose_,
                            by_rows(samples_of_b_ ? R_QP_ : Mat3(Mat3::Identity())),
                            {origin_A.x(), origin_A.y(), origin_A.z()},
                            samples_of_b_,
                            search_margin(reach.kept),
                            beside_crossings(reach, motion)};
  append_candidates(surface, scratch.search.hits, search_margin(reach.searched), motion.closing(),
                    scratch.lanes, scratch.candidates);
}

}  // namespace gotai::collision
