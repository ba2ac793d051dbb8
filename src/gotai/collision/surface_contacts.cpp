#include "gotai/collision/surface_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "gotai/collision/anchored_contacts.h"
#include "gotai/collision/pair_motion.h"
#include "gotai/collision/relative_pose.h"
#include "gotai/collision/surface_faces.h"
#include "gotai/collision/surface_sample.h"

namespace gotai::collision {
namespace {

using model::BodyIndex;
using model::BodyState;
using Shapes = std::span<const std::shared_ptr<const voxel::Shape>>;

SamplePose sample_pose(const Pose& X_BA, const voxel::SurfaceModel& a,
                       const voxel::SurfaceModel& b) {
  return make_sample_pose(X_BA.q.toRotationMatrix(), X_BA * a.center - b.center);
}

// Largest float that is not above the margin, so that searches keep the promise of the margin.
float search_margin(double margin) {
  const auto rounded = static_cast<float>(margin);
  return static_cast<double>(rounded) > margin ? std::nextafter(rounded, 0.0F) : rounded;
}

// The deepest contact is taken beside remembered ones only if deeper by this fraction of the size.
constexpr double kDepthStep = 2e-4;
// Contacts farther than this are impacts to come, not what bodies rest on [cells].
constexpr float kFarCells = 2.0F;
// Interpolated distances are off by less than half the diagonal of a cell [cells].
constexpr double kFieldError = 0.9;

// Samples of one body, P, in the field of the other, Q.
class FieldContacts {
 public:
  // @param exact  empty: samples stay where they are
  FieldContacts(const BodyState& bodies, const BodyPair& pair, Shapes shapes, ExactSurfaces exact,
                bool samples_of_b)
      : samples_of_b_(samples_of_b),
        p_MA_(bodies.p_MB[pair.body_a]),
        samples_(shapes[bodies.shape[samples_of_b ? pair.body_b : pair.body_a]]->surface),
        field_(shapes[bodies.shape[samples_of_b ? pair.body_a : pair.body_b]]->surface),
        X_QP_(samples_of_b
                  ? relative_pose(bodies.mesh_pose(pair.body_a), bodies.mesh_pose(pair.body_b))
                  : relative_pose(bodies.mesh_pose(pair.body_b), bodies.mesh_pose(pair.body_a))),
        R_QP_(X_QP_.q.toRotationMatrix()) {
    const std::uint32_t shape = bodies.shape[samples_of_b ? pair.body_b : pair.body_a];
    if (!exact.empty() && exact[shape] != nullptr) curved_ = &exact[shape]->curved;
  }

  // @param thin  of samples that are far away, one in each packet is enough
  void append(double margin, const PairMotion& motion, NearSamples* near, bool thin,
              SurfaceScratch& scratch) const {
    const SamplePose pose = sample_pose(X_QP_, samples_, field_);
    if (near != nullptr) {
      search_field(samples_, field_.field, pose, search_margin(margin), motion.farthest(), *near,
                   scratch.search);
    } else {
      search_field(samples_.tree, field_.field, pose, search_margin(margin), scratch.search);
    }
    if (thin) leave_out_far_neighbours(scratch.search.hits);
    for (const SurfaceHit& hit : scratch.search.hits) append(hit, motion, scratch.candidates);
  }

  // Replaces gap and normal by those of Q's triangles. A sample of a face first gives way to the
  // deepest of the mesh's vertices around it. A sample of an edge slides to where its edge is
  // nearest, if that is between it and its neighbours: with flat faces on both sides of the nearest
  // point, where the two lines of the distance along the edge cross. The normal remains the field's
  // where the nearest point is on an edge: there the field's is a mean that does not jump.
  void refine(const ExactSurface& exact, ContactCandidate& c) const {
    const auto sample = static_cast<std::uint32_t>(c.feature);
    const FieldPoint own = deepest_vertex(sample, c.gap);
    const double error = kFieldError * field_.field.cell;
    const double limit = std::abs(own.distance) + error;
    const std::int32_t edge = samples_.tree.edge[sample];
    const Vec3 edge_P =
        edge < 0 ? Vec3(Vec3::Zero())
                 : to_double(samples_.tree.edge_direction[static_cast<std::size_t>(edge)]);
    Slid best = slide(exact, own.x_P, edge_P, 0.0, limit);
    if (edge >= 0 && std::isfinite(best.distance)) {
      const auto& reach = samples_.tree.edge_reach[static_cast<std::size_t>(edge)];
      const double far =
          best.slope < 0.0 ? static_cast<double>(reach[1]) : -static_cast<double>(reach[0]);
      const Slid end = slide(exact, own.x_P, edge_P, far, limit + std::abs(far));
      if (far != 0.0 && std::isfinite(end.distance) && end.slope * best.slope < 0.0) {
        const double along =
            (end.distance - end.slope * far - best.distance) / (best.slope - end.slope);
        const Slid crossing = slide(exact, own.x_P, edge_P, along, limit + std::abs(far));
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

  // Replaces the gap by the distance of the sample itself to Q's triangles, for contacts that push
  // in a step. Following edges and faces would be exact for one pose, but their nearest points and
  // normals jump as bodies rock, and piles never rest (of 500 hexapods 492 kept moving, at 3e-3
  // m/s).
  void refine_in_place(const ExactSurface& exact, ContactCandidate& c) const {
    const double error = kFieldError * field_.field.cell;
    const Vec3 own_A = samples_of_b_ ? Vec3(c.point_A - c.gap * c.normal_A) : c.point_A;
    const Vec3 own_Q = samples_of_b_ ? Vec3(own_A + p_MA_) : Vec3(X_QP_ * (own_A + p_MA_));
    const double distance = exact.nearest(own_Q, std::abs(c.gap) + error).distance;
    if (!(std::abs(distance - c.gap) <= error)) return;
    c.gap = distance;
    if (samples_of_b_) c.point_A = own_A + c.gap * c.normal_A;
  }

 private:
  // A point of P in Q's field.
  struct FieldPoint {
    Vec3 x_P;
    double distance;
    Vec3 gradient_P;
  };

  // Of a packet whose samples are all far from Q, the nearest stands for all: it lies within a few
  // cells of them, and what comes near is searched again.
  void leave_out_far_neighbours(std::vector<SurfaceHit>& hits) const {
    const float far = kFarCells * field_.field.cell;
    std::size_t count = 0;
    for (std::size_t i = 0; i < hits.size();) {
      const std::uint32_t packet = hits[i].sample / voxel::kLanes;
      const std::size_t first = i;
      std::size_t nearest = i;
      while (++i < hits.size() && hits[i].sample / voxel::kLanes == packet) {
        if (hits[i].distance < hits[nearest].distance) nearest = i;
      }
      if (hits[nearest].distance > far) {
        hits[count++] = hits[nearest];
      } else {
        for (std::size_t k = first; k < i; ++k) hits[count++] = hits[k];
      }
    }
    hits.resize(count);
  }

  void append(const SurfaceHit& hit, const PairMotion& motion,
              std::vector<ContactCandidate>& out) const {
    const CurvedSample* bent = curved_ == nullptr ? nullptr : curved_->find(hit.sample);
    FieldPoint own{sample_point(samples_, hit.sample), hit.distance,
                   R_QP_.transpose() * to_double(hit.gradient)};
    if (bent != nullptr && !follow(*bent, own)) return;
    const double length = own.gradient_P.norm();
    // Where the field has no slope (the middle of a body) the sample's own normal is all there is.
    const Vec3 toward = length > 1e-3 ? Vec3(-own.gradient_P / length)
                                      : to_double(samples_.tree.normal[hit.sample]).normalized();
    const Vec3 d_P = fit_to_normal_cone(samples_.tree, hit.sample, toward);
    if (d_P.isZero()) return;
    ContactCandidate c;
    c.gap = own.distance;
    c.area = facing_area(samples_, hit.sample, d_P);
    if (samples_of_b_) {
      c.normal_A = R_QP_ * d_P;
      c.point_A = R_QP_ * own.x_P + (X_QP_.p - p_MA_) + c.gap * c.normal_A;
    } else {
      c.normal_A = -d_P;
      c.point_A = own.x_P - p_MA_;
    }
    c.share_A = c.point_A;
    c.feature = surface_feature(samples_of_b_ ? 1 : 0, hit.sample);
    // Where a field is smooth its slope is 1.
    constexpr double kSmooth = 0.005;
    c.near_edge =
        std::abs(length - 1.0) > kSmooth || samples_.tree.edge[hit.sample] >= 0 ||
        samples_.tree.first_vertex[hit.sample] < samples_.tree.first_vertex[hit.sample + 1];
    if (motion.may_close(c)) out.push_back(c);
  }

  FieldPoint look_up(const Vec3& x_P) const {
    const voxel::FieldValue there = voxel::evaluate(field_.field, X_QP_ * x_P - field_.center);
    return {x_P, there.distance, R_QP_.transpose() * there.gradient};
  }

  // Slides a point of a curved surface to where it faces Q. Q may be curved too: the direction
  // turns on the way, and where two slides end tells where the next would, so that the third is
  // there.
  // @return false where others stand for that place; not while the sample itself overlaps
  bool follow(const CurvedSample& sample, FieldPoint& own) const {
    constexpr double kStraight = 0.05;
    constexpr double kSteepest = 0.5;
    const auto slide_from = [&](const FieldPoint& at) {
      return slide_to_face(sample, -at.gradient_P.normalized());
    };
    const auto is_near = [&](const Eigen::Vector2d& slide) {
      return slide.norm() <= curved_->reach();
    };
    Eigen::Vector2d slide = slide_from(own);
    if (!is_near(slide)) return own.distance <= 0.0;
    FieldPoint there = look_up(samples_.center + slid_point(sample, slide));
    const Eigen::Vector2d turn = slide_from(there) - slide;
    if (turn.norm() > kStraight * slide.norm()) {
      for (int k = 0; k < 2; ++k) {
        const double share = slide[k] == 0.0 ? 0.0 : std::min(turn[k] / slide[k], kSteepest);
        slide[k] /= 1.0 - share;
      }
      there = look_up(samples_.center + slid_point(sample, slide));
    }
    if (there.distance < own.distance) own = there;
    return true;
  }

  // A sample or, if deeper, one of the vertices that it stands for.
  FieldPoint deepest_vertex(std::uint32_t sample, double gap) const {
    const voxel::SurfaceTree& tree = samples_.tree;
    FieldPoint deepest{sample_point(samples_, sample), gap, Vec3::Zero()};
    for (std::uint32_t v = tree.first_vertex[sample]; v < tree.first_vertex[sample + 1]; ++v) {
      const Vec3 x_P = samples_.center + to_double(tree.vertex[v]);
      const double distance = voxel::evaluate(field_.field, X_QP_ * x_P - field_.center).distance;
      if (distance < deepest.distance) deepest = {x_P, distance, Vec3::Zero()};
    }
    return deepest;
  }

  // Distance of a sample of P to Q's triangles after sliding along its edge, and how it changes.
  struct Slid {
    double along = 0.0;  // [m]
    double distance = std::numeric_limits<double>::infinity();
    double slope = 0.0;          // of the distance along the edge
    Vec3 face_Q = Vec3::Zero();  // outward normal where the nearest point is inside a face, else 0
  };
  Slid slide(const ExactSurface& exact, const Vec3& own_P, const Vec3& edge_P, double along,
             double limit) const {
    const Vec3 x_Q = X_QP_ * (own_P + along * edge_P);
    const voxel::ClosestPoint nearest = exact.nearest(x_Q, limit);
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

  bool samples_of_b_;
  Vec3 p_MA_;
  const voxel::SurfaceModel& samples_;
  const voxel::SurfaceModel& field_;
  Pose X_QP_;  // P's mesh frame in Q's
  Mat3 R_QP_;
  const CurvedSamples* curved_ = nullptr;  // of P
};

// The part of the memory that belongs to a pair.
std::span<const model::ContactMemory::Entry> remembered(
    std::span<const model::ContactMemory::Entry> memory, const BodyPair& pair) {
  const auto key = [](const model::ContactMemory::Entry& e) {
    return std::pair(e.body_a, e.body_b);
  };
  const std::pair bodies(pair.body_a, pair.body_b);
  const auto begin = std::ranges::lower_bound(memory, bodies, {}, key);
  return {begin, std::ranges::upper_bound(begin, memory.end(), bodies, {}, key)};
}

// Gaps of the kept contacts of two shapes that may carry soon, measured to triangles: where a field
// rounds, or in a step for all of them, so that no gap jumps when the field's smoothness does.
void refine_kept(const BodyState& bodies, const BodyPair& pair, Shapes shapes, ExactSurfaces exact,
                 double reach, bool in_step, SurfaceScratch& scratch) {
  double deepest = std::numeric_limits<double>::infinity();
  for (const std::uint32_t k : scratch.reduction.kept) {
    deepest = std::min(deepest, scratch.candidates[k].gap);
  }
  const FieldContacts of_a(bodies, pair, shapes, exact, false);
  const FieldContacts of_b(bodies, pair, shapes, exact, true);
  const ExactSurface* exact_a = exact[bodies.shape[pair.body_a]].get();
  const ExactSurface* exact_b = exact[bodies.shape[pair.body_b]].get();
  for (const std::uint32_t k : scratch.reduction.kept) {
    ContactCandidate& c = scratch.candidates[k];
    if (c.gap > std::max(deepest, 0.0) + reach) continue;
    const bool is_of_b = (c.feature >> 32U) != 0;
    const FieldContacts& field = is_of_b ? of_b : of_a;
    const ExactSurface* surface = is_of_b ? exact_a : exact_b;
    if (surface == nullptr) continue;
    if (in_step) {
      field.refine_in_place(*surface, c);
    } else if (c.near_edge) {
      field.refine(*surface, c);
    }
  }
}

void emit(const BodyState& bodies, const BodyPair& pair, const ContactCandidate& c,
          const Mat3& R_WA, const Mat3& R_WB, model::ContactSet& out) {
  const Vec3& x_A = bodies.x_W[pair.body_a];
  const Vec3 normal = (R_WA * c.normal_A).normalized();
  const Vec3 on_a = R_WA * c.point_A;
  const Vec3 on_b = on_a - c.gap * normal;
  out.push(x_A + 0.5 * (on_a + on_b), normal, c.gap, c.point_A,
           R_WB.transpose() * ((x_A - bodies.x_W[pair.body_b]) + on_b), c.area, c.feature);
  out.friction_W.back() = x_A + R_WA * (c.share_A - (0.5 * c.gap) * c.normal_A);
}

// Are two shapes still farther apart than the reach, by what the last search knew? The samples of b
// that count are near body a, so that they move against it no farther than its own surface.
bool is_still_apart(const NearPair& near, const BodyState& bodies, const BodyPair& pair,
                    Shapes shapes, double reach) {
  if (!near.apart) return false;
  const voxel::DistanceField& field_a = shapes[bodies.shape[pair.body_a]]->surface.field;
  const voxel::DistanceField& field_b = shapes[bodies.shape[pair.body_b]]->surface.field;
  const double around = bodies.bounding_radius[pair.body_a] +
                        4.0 * static_cast<double>(std::max(field_a.cell, field_b.cell)) + reach;
  const auto moved = static_cast<float>(displacement(near.X_BA, body_pose(bodies, pair), around));
  const float margin = search_margin(reach);
  return is_still_empty(near.way[0], moved, margin, field_b) &&
         is_still_empty(near.way[1], moved, margin, field_a);
}

// Finds the candidates for contacts at the present poses.
void find_candidates(const BodyState& bodies, const BodyPair& pair, Shapes shapes,
                     ExactSurfaces smooth, double reach, const PairMotion& motion, bool thin,
                     SurfaceScratch& scratch, NearPair* near) {
  scratch.candidates.clear();
  if (bodies.geometry[pair.body_b] != model::Geometry::shape) {
    append_face_contacts(bodies, pair, shapes, smooth, reach, motion, scratch);
    return;
  }
  if (near != nullptr && is_still_apart(*near, bodies, pair, shapes, reach)) return;
  for (const bool samples_of_b : {false, true}) {
    NearSamples* one_way = near == nullptr ? nullptr : &near->way[samples_of_b ? 1 : 0];
    FieldContacts(bodies, pair, shapes, smooth, samples_of_b)
        .append(reach, motion, one_way, thin, scratch);
  }
  if (near == nullptr) return;
  near->apart = std::ranges::all_of(
      near->way, [](const NearSamples& way) { return way.margin >= 0.0F && way.packets.empty(); });
  if (near->apart) near->X_BA = body_pose(bodies, pair);
}

// Keeps few candidates, and measures their gaps.
void reduce_candidates(const BodyState& bodies, const BodyPair& pair, Shapes shapes,
                       ExactSurfaces exact, const SearchOptions& options, const PairMotion& motion,
                       SurfaceScratch& scratch) {
  reduce_contacts(scratch.candidates, remembered(options.memory, pair),
                  {.length = motion.size(),
                   .depth_step = kDepthStep * motion.size(),
                   .reach = motion.rest_reach()},
                  scratch.reduction);
  scratch.reduction_error = std::max(scratch.reduction_error, scratch.reduction.error);
  if (!exact.empty() && bodies.geometry[pair.body_b] == model::Geometry::shape) {
    refine_kept(bodies, pair, shapes, exact, motion.rest_reach(), options.dt > 0.0, scratch);
  }
}

// Anchors the kept candidates at the present poses.
void anchor_kept(const BodyState& bodies, double reach, const SurfaceScratch& scratch,
                 model::ContactAnchors::Pair& anchor) {
  anchor.X_BA = body_pose(bodies, {anchor.body_a, anchor.body_b});
  anchor.reach = reach;
  const Mat3 R_BA = anchor.X_BA.q.toRotationMatrix();
  for (const std::uint32_t k : scratch.reduction.kept) {
    const ContactCandidate& c = scratch.candidates[k];
    anchor.contacts.push_back({c.point_A, anchor.X_BA.p + R_BA * (c.point_A - c.gap * c.normal_A),
                               (R_BA * c.normal_A).normalized(),
                               c.share_A - (0.5 * c.gap) * c.normal_A, c.area, c.feature});
  }
}

}  // namespace

void append_surface_contacts(const BodyState& bodies, const BodyPair& pair, Shapes shapes,
                             ExactSurfaces exact, double margin, const SearchOptions& options,
                             SurfaceScratch& scratch, model::ContactSet& out, NearPair* near,
                             model::ContactAnchors::Pair* anchor) {
  const PairMotion motion(bodies, pair, options.dt);
  double reach = motion.reach(margin);
  if (anchor != nullptr) {
    if (!anchor->contacts.empty() && is_near_anchor(*anchor, bodies, motion, reach)) {
      append_anchored(*anchor, bodies, out);
      return;
    }
    anchor->contacts.clear();
    reach += kAnchorTolerance * motion.size();
  }
  // Bodies move on the smooth surfaces that their meshes stand for; outside steps meshes decide.
  const ExactSurfaces smooth = options.dt > 0.0 ? exact : ExactSurfaces{};
  const bool reduced = options.contacts == model::ContactTreatment::reduced;
  find_candidates(bodies, pair, shapes, smooth, reach, motion, reduced && options.dt > 0.0, scratch,
                  near);
  if (scratch.candidates.empty()) return;
  if (reduced) reduce_candidates(bodies, pair, shapes, exact, options, motion, scratch);
  if (anchor != nullptr) {
    anchor_kept(bodies, reach, scratch, *anchor);
    append_anchored(*anchor, bodies, out);
    return;
  }
  const auto begin = static_cast<std::uint32_t>(out.size());
  out.pairs.push_back({pair.body_a, pair.body_b, begin, begin});
  const Mat3 R_WA = bodies.q_WB[pair.body_a].toRotationMatrix();
  const Mat3 R_WB = bodies.q_WB[pair.body_b].toRotationMatrix();
  if (reduced) {
    for (const std::uint32_t k : scratch.reduction.kept) {
      emit(bodies, pair, scratch.candidates[k], R_WA, R_WB, out);
    }
  } else {
    for (const ContactCandidate& c : scratch.candidates) emit(bodies, pair, c, R_WA, R_WB, out);
  }
}

}  // namespace gotai::collision
