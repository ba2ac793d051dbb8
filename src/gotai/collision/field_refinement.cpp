// Gaps and normals of contacts from the triangles that a field is of.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "gotai/collision/field_contacts.h"
#include "gotai/collision/surface_sample.h"

namespace gotai::collision {
namespace {

// Interpolated distances are off by less than half the diagonal of a cell [cells].
constexpr double kFieldError = 0.9;
constexpr double kLikelyError = 0.1;  // by less, mostly [cells]
// Crossings of edges are off by less along the edge [cells].
constexpr double kCrossingError = 0.5;
// Slopes along an edge below which it is nearly parallel to a face.
constexpr double kSteep = 0.02;
constexpr double kLeastCosine = 0.3;

}  // namespace

struct FieldContacts::Slid {
  double along = 0.0;  // [m]
  double distance = std::numeric_limits<double>::infinity();
  double slope = 0.0;          // of the distance along the edge
  Vec3 up_Q = Vec3::Zero();    // unit, away from the nearest point, or out of the body
  std::uint32_t triangle = 0;  // the nearest of Q
};

void FieldContacts::refine(const ExactSurface& exact, SurfaceScratch& scratch) const {
  look_up_vertices(scratch);
  const RefinementScratch& refinement = scratch.refinement;
  std::size_t vertex = 0;
  for (std::size_t i = 0; i < refinement.candidates.size(); ++i) {
    ContactCandidate& c = scratch.candidates[refinement.candidates[i]];
    FieldPoint deepest{sample_point(samples_, static_cast<std::uint32_t>(c.feature)), c.gap};
    for (; vertex < refinement.vertices_end[i]; ++vertex) {
      const auto distance = static_cast<double>(refinement.values[vertex].distance);
      if (distance < deepest.distance) {
        deepest = {samples_.center + to_double(refinement.vertices[vertex]), distance};
      }
    }
    refine_from(deepest, exact, c);
  }
}

// The vertices around all these samples in Q's field, in one go.
void FieldContacts::look_up_vertices(SurfaceScratch& scratch) const {
  RefinementScratch& refinement = scratch.refinement;
  refinement.vertices.clear();
  refinement.vertices_end.clear();
  auto margin = -std::numeric_limits<float>::infinity();
  for (const std::uint32_t k : refinement.candidates) {
    const ContactCandidate& c = scratch.candidates[k];
    for (const std::array<float, 3>& x :
         samples_.tree.vertices_of(static_cast<std::uint32_t>(c.feature))) {
      refinement.vertices.push_back(x);
    }
    refinement.vertices_end.push_back(refinement.vertices.size());
    margin = std::max(margin, static_cast<float>(c.gap));
  }
  if (refinement.vertices.empty()) return;
  if (refinement.values.size() < refinement.vertices.size()) {
    refinement.values.resize(refinement.vertices.size());
  }
  look_up_field(field_.field, pose_, margin, refinement.vertices, refinement.values);
}

void FieldContacts::refine_from(const FieldPoint& own, const ExactSurface& exact,
                                ContactCandidate& c) const {
  const double error = kFieldError * field_.field.cell;
  const double limit = std::abs(own.distance) + error;
  const voxel::SampleEdge* edge = samples_.tree.edge_of(static_cast<std::uint32_t>(c.feature));
  const Vec3 edge_P = edge == nullptr ? Vec3(Vec3::Zero()) : to_double(edge->direction);
  Slid best = slide(exact, own.x_P, edge_P, 0.0, limit, own.distance);
  if (edge != nullptr && std::isfinite(best.distance)) {
    const double far =
        best.slope < 0.0 ? static_cast<double>(edge->forward) : -static_cast<double>(edge->back);
    const Slid end =
        rises_at(own.x_P + far * edge_P, far * edge_P)
            ? slide(exact, own.x_P, edge_P, far, limit + std::abs(far), limit + std::abs(far))
            : Slid{};
    if (std::isfinite(end.distance) && end.slope * best.slope < 0.0) {
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
  const Vec3 face_Q = exact.surface.face_normal(best.triangle);
  const bool is_above_face = best.up_Q.dot(face_Q) > 1.0 - 1e-6;
  if (is_above_face) {
    c.normal_A = samples_of_b_ ? Vec3(-face_Q) : Vec3(R_QP_.transpose() * face_Q);
  }
  put_at(own.x_P + best.along * edge_P, c);
}

// Does Q's field rise along a direction there?
bool FieldContacts::rises_at(const Vec3& x_P, const Vec3& along_P) const {
  const Eigen::Vector3f x = (x_P - samples_.center).cast<float>();
  const std::array<std::array<float, 3>, 1> point = {{{x.x(), x.y(), x.z()}}};
  std::array<FieldAtPoint, 1> value;
  look_up_field(field_.field, pose_, field_.field.trusted, point, value);
  return to_double(value[0].slope).dot(along_P) > 0.0;
}

void FieldContacts::refine_in_step(const ExactSurface& exact, ContactCandidate& c) const {
  const Vec3 own_A = samples_of_b_ ? Vec3(c.point_A - c.gap * c.normal_A) : c.point_A;
  const Vec3 own_Q = samples_of_b_ ? Vec3(own_A + p_MA_) : Vec3(X_QP_ * (own_A + p_MA_));
  if (c.crosses) {
    refine_crossing(exact, own_Q, c);
    return;
  }
  const double error = kFieldError * field_.field.cell;
  const double own = std::abs(c.gap);
  const double likely = own + kLikelyError * field_.field.cell;
  const double distance = exact.nearest(own_Q, own + error, likely).distance;
  if (!(std::abs(distance - c.gap) <= error)) return;
  c.gap = distance;
  if (samples_of_b_) c.point_A = own_A + c.gap * c.normal_A;
}

// Where edges cross the field is rounded: the nearest point is somewhat farther along the edge,
// with one of the two faces of Q on either side of it.
void FieldContacts::refine_crossing(const ExactSurface& exact, const Vec3& own_Q,
                                    ContactCandidate& c) const {
  const double reach = kCrossingError * field_.field.cell;
  // Only samples of edges cross.
  const voxel::SampleEdge* edge = samples_.tree.edge_of(static_cast<std::uint32_t>(c.feature));
  const Vec3 own_P = X_QP_.inverse() * own_Q;
  const Vec3 edge_P = to_double(edge->direction);
  const auto slide_to = [&](double along, double distance) {
    return slide(exact, own_P, edge_P, along, std::abs(distance) + kFieldError * field_.field.cell,
                 distance);
  };
  const Slid own = slide_to(0.0, c.gap);
  const Slid end = slide_to(own.slope < 0.0 ? reach : -reach, own.distance);
  if (!std::isfinite(own.distance) || !std::isfinite(end.distance)) return;
  const bool crosses = own.slope * end.slope < 0.0;
  Slid best = end.distance < own.distance ? end : own;
  Vec3 n_Q = samples_of_b_ ? Vec3(-c.normal_A) : Vec3(R_QP_ * c.normal_A);
  if (crosses) {
    // Nearly parallel to a face the nearest point jumps when bodies rock: only a part of the way.
    const double share = std::min(1.0, std::min(std::abs(own.slope), std::abs(end.slope)) / kSteep);
    const double along =
        (own.distance - end.distance + end.slope * end.along) / (end.slope - own.slope);
    best = slide_to(share * along, own.distance + own.slope * share * along);
    n_Q = (std::abs(end.slope) * own.up_Q + std::abs(own.slope) * end.up_Q).normalized();
  }
  // Along the common normal edges are farther in each other than one is in a face of the other.
  c.gap = best.distance < 0.0 ? best.distance / std::max(kLeastCosine, n_Q.dot(best.up_Q))
                              : best.distance;
  c.normal_A = samples_of_b_ ? Vec3(-n_Q) : Vec3(R_QP_.transpose() * n_Q);
  put_at(own_P + best.along * edge_P, c);
}

// The contact's point on body a, for a point of P.
void FieldContacts::put_at(const Vec3& x_P, ContactCandidate& c) const {
  c.point_A = samples_of_b_ ? Vec3(X_QP_ * x_P - p_MA_ + c.gap * c.normal_A) : Vec3(x_P - p_MA_);
}

FieldContacts::Slid FieldContacts::slide(const ExactSurface& exact, const Vec3& own_P,
                                         const Vec3& edge_P, double along, double limit,
                                         double expected) const {
  const Vec3 x_Q = X_QP_ * (own_P + along * edge_P);
  const double likely = std::abs(expected) + kLikelyError * field_.field.cell;
  const voxel::ClosestPoint nearest = exact.nearest(x_Q, limit, likely);
  if (!std::isfinite(nearest.distance)) return {};
  const double length = std::abs(nearest.distance);
  const Vec3 up =
      length > 1e-9 * limit
          ? Vec3((x_Q - nearest.point) * (std::copysign(1.0, nearest.distance) / length))
          : nearest.pseudonormal;
  return {along, nearest.distance, up.dot(R_QP_ * edge_P), up, nearest.triangle};
}

}  // namespace gotai::collision
