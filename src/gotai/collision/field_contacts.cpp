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
// Interpolated distances are off by less than half the diagonal of a cell [cells].
constexpr double kFieldError = 0.9;
constexpr double kLikelyError = 0.1;  // by less, mostly [cells]

std::array<double, 9> by_rows(const Mat3& R) {
  return {R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)};
}

}  // namespace

struct FieldContacts::Slid {
  double along = 0.0;  // [m]
  double distance = std::numeric_limits<double>::infinity();
  double slope = 0.0;          // of the distance along the edge
  Vec3 face_Q = Vec3::Zero();  // outward normal where the nearest point is inside a face, else 0
};

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
}

float FieldContacts::search_margin(double margin) {
  const auto rounded = static_cast<float>(margin);
  return static_cast<double>(rounded) > margin ? std::nextafter(rounded, 0.0F) : rounded;
}

void FieldContacts::append(double margin, const PairMotion& motion, NearSamples* near, bool thin,
                           SurfaceScratch& scratch) const {
  const SearchReach reach = search_reach(margin, motion, thin);
  if (near != nullptr) {
    search_field(samples_, field_.field, pose_, reach, motion.farthest(), *near, scratch.search);
  } else {
    search_field(samples_.tree, field_.field, pose_, reach, scratch.search);
  }
  append_hits(reach.margin, motion, scratch);
}

double FieldContacts::append_if_near(double margin, double wide, const PairMotion& motion,
                                     bool thin, SurfaceScratch& scratch) const {
  const SearchReach reach = search_reach(margin, motion, thin);
  search_field_widely(samples_.tree, field_.field, pose_, reach, static_cast<float>(wide),
                      scratch.search);
  append_hits(reach.margin, motion, scratch);
  return static_cast<double>(scratch.search.clearance);
}

void FieldContacts::refine(const ExactSurface& exact, ContactCandidate& c) const {
  const auto sample = static_cast<std::uint32_t>(c.feature);
  const FieldPoint own = deepest_vertex(sample, c.gap);
  const double error = kFieldError * field_.field.cell;
  const double limit = std::abs(own.distance) + error;
  const std::int32_t edge = samples_.tree.edge[sample];
  const Vec3 edge_P = edge < 0
                          ? Vec3(Vec3::Zero())
                          : to_double(samples_.tree.edge_direction[static_cast<std::size_t>(edge)]);
  Slid best = slide(exact, own.x_P, edge_P, 0.0, limit, own.distance);
  if (edge >= 0 && std::isfinite(best.distance)) {
    const auto& reach = samples_.tree.edge_reach[static_cast<std::size_t>(edge)];
    const double far =
        best.slope < 0.0 ? static_cast<double>(reach[1]) : -static_cast<double>(reach[0]);
    const Slid end =
        slide(exact, own.x_P, edge_P, far, limit + std::abs(far), limit + std::abs(far));
    if (far != 0.0 && std::isfinite(end.distance) && end.slope * best.slope < 0.0) {
      const double along =
          (end.distance - end.slope * far - best.distance) / (best.slope - end.slope);
      const Slid crossing = slide(exact, own.x_P, edge_P, along, limit + std::abs(far),
                                  best.distance + best.slope * along);
      if (std::abs(along) <= std::abs(far) && along * far >= 0.0 &&
          crossing.distance < best.distance) {
        best = crossing;
      }
    }
  }
  // Fields are never off by more: a larger difference means that the sides were mistaken.
  if (!(best.distance <= own.distance + error && best.distance >= own.distance - 3.0 * error)) {
    return;
  }
  c.gap = best.distance;
  if (!best.face_Q.isZero()) {
    c.normal_A = samples_of_b_ ? Vec3(-best.face_Q) : Vec3(R_QP_.transpose() * best.face_Q);
  }
  const Vec3 moved_P = own.x_P + best.along * edge_P;
  c.point_A =
      samples_of_b_ ? Vec3(X_QP_ * moved_P - p_MA_ + c.gap * c.normal_A) : Vec3(moved_P - p_MA_);
}

void FieldContacts::refine_in_place(const ExactSurface& exact, ContactCandidate& c) const {
  const double error = kFieldError * field_.field.cell;
  const Vec3 own_A = samples_of_b_ ? Vec3(c.point_A - c.gap * c.normal_A) : c.point_A;
  const Vec3 own_Q = samples_of_b_ ? Vec3(own_A + p_MA_) : Vec3(X_QP_ * (own_A + p_MA_));
  const double own = std::abs(c.gap);
  const double likely = own + kLikelyError * field_.field.cell;
  const double distance = exact.nearest(own_Q, own + error, likely).distance;
  if (!(std::abs(distance - c.gap) <= error)) return;
  c.gap = distance;
  if (samples_of_b_) c.point_A = own_A + c.gap * c.normal_A;
}

// Of a packet none of whose samples may carry, the nearest stands for all: it lies within a few
// cells of them, and what comes near is searched again. Far packets are for bodies that fly: lists
// of near samples know nothing of them, and serve smaller margins only.
SearchReach FieldContacts::search_reach(double margin, const PairMotion& motion, bool thin) const {
  if (!thin) return search_margin(margin);
  const float far = kFarCells * field_.field.cell;
  const float reach = search_margin(margin);
  return {reach, static_cast<float>(motion.rest_reach()),
          motion.in_step() && reach > far ? far : std::numeric_limits<float>::infinity()};
}

void FieldContacts::append_hits(float margin, const PairMotion& motion,
                                SurfaceScratch& scratch) const {
  if (scratch.search.hits.empty()) return;
  const Vec3 origin_A = (samples_of_b_ ? X_QP_ * samples_.center : samples_.center) - p_MA_;
  const NearSurface surface{samples_,
                            field_.field,
                            curved_,
                            pose_,
                            by_rows(samples_of_b_ ? R_QP_ : Mat3(Mat3::Identity())),
                            {origin_A.x(), origin_A.y(), origin_A.z()},
                            samples_of_b_};
  append_candidates(surface, scratch.search.hits, margin, motion.closing(), scratch.lanes,
                    scratch.candidates);
}

// A sample or, if deeper, one of the vertices that it stands for.
FieldContacts::FieldPoint FieldContacts::deepest_vertex(std::uint32_t sample, double gap) const {
  const voxel::SurfaceTree& tree = samples_.tree;
  FieldPoint deepest{sample_point(samples_, sample), gap};
  const std::uint32_t first = tree.first_vertex[sample];
  const std::uint32_t last = tree.first_vertex[sample + 1];
  std::array<float, voxel::kLanes> distances;
  for (std::uint32_t begin = first; begin < last; begin += voxel::kLanes) {
    const std::size_t count = std::min<std::size_t>(voxel::kLanes, last - begin);
    look_up_distances(field_.field, pose_, static_cast<float>(gap),
                      std::span(tree.vertex).subspan(begin, count), std::span(distances));
    for (std::size_t i = 0; i < count; ++i) {
      const double distance = static_cast<double>(distances[i]);
      if (distance < deepest.distance) {
        deepest = {samples_.center + to_double(tree.vertex[begin + i]), distance};
      }
    }
  }
  return deepest;
}

FieldContacts::Slid FieldContacts::slide(const ExactSurface& exact, const Vec3& own_P,
                                         const Vec3& edge_P, double along, double limit,
                                         double expected) const {
  const Vec3 x_Q = X_QP_ * (own_P + along * edge_P);
  const double likely = std::abs(expected) + kLikelyError * field_.field.cell;
  const voxel::ClosestPoint nearest = exact.nearest(x_Q, limit, likely);
  if (!std::isfinite(nearest.distance)) return {};
  const Vec3 away = x_Q - nearest.point;
  const double length = away.norm();
  const Vec3 up = length > 1e-9 * limit
                      ? Vec3(away * (std::copysign(1.0, nearest.distance) / length))
                      : nearest.pseudonormal;
  const Vec3& face = exact.surface.face_normal(nearest.triangle);
  const bool is_above_face = up.dot(face) > 1.0 - 1e-6;
  return {along, nearest.distance, up.dot(R_QP_ * edge_P),
          is_above_face ? face : Vec3(Vec3::Zero())};
}

}  // namespace gotai::collision
