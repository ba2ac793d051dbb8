#include "gotai/collision/surface_contacts.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "gotai/collision/anchored_contacts.h"
#include "gotai/collision/field_contacts.h"
#include "gotai/collision/pair_motion.h"
#include "gotai/collision/relative_pose.h"
#include "gotai/collision/surface_faces.h"

namespace gotai::collision {
namespace {

using model::BodyIndex;
using model::BodyState;
using Shapes = std::span<const std::shared_ptr<const voxel::Shape>>;

// The deepest contact is taken beside remembered ones only if deeper by this fraction of the size.
constexpr double kDepthStep = 2e-4;
// Bodies that are apart are asked how far, up to this far beyond what is searched [cells].
constexpr double kBeyond = 0.25;

// Two shapes, each with its samples in the field of the other.
struct BothWays {
  FieldContacts of_a, of_b;
  BothWays(const BodyState& bodies, const BodyPair& pair, Shapes shapes, ExactSurfaces smooth)
      : BothWays(bodies, pair, shapes, smooth,
                 relative_pose(bodies.mesh_pose(pair.body_b), bodies.mesh_pose(pair.body_a))) {}

 private:
  BothWays(const BodyState& bodies, const BodyPair& pair, Shapes shapes, ExactSurfaces smooth,
           const Pose& X_BA)
      : of_a(bodies, pair, shapes, smooth, false, X_BA),
        of_b(bodies, pair, shapes, smooth, true, X_BA.inverse()) {}
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
// @param reach  contacts that are farther than the deepest by more, even less what the field may
//               round off, are not measured [m]
void refine_kept(const BothWays& ways, const ExactSurface* exact_a, const ExactSurface* exact_b,
                 double reach, bool in_step, SurfaceScratch& scratch) {
  double deepest = std::numeric_limits<double>::infinity();
  for (const std::uint32_t k : scratch.reduction.kept) {
    deepest = std::min(deepest, scratch.candidates[k].gap);
  }
  std::vector<std::uint32_t>& refined = scratch.refinement.candidates;
  for (const bool of_b : {false, true}) {
    const FieldContacts& field = of_b ? ways.of_b : ways.of_a;
    const ExactSurface* surface = of_b ? exact_a : exact_b;
    if (surface == nullptr) continue;
    refined.clear();
    for (const std::uint32_t k : scratch.reduction.kept) {
      const ContactCandidate& c = scratch.candidates[k];
      const double rounding = in_step && c.near_edge ? field.rounding() : 0.0;
      if (((c.feature >> 32U) != 0) == of_b && (in_step || c.near_edge) &&
          c.gap <= std::max(deepest, 0.0) + reach + rounding) {
        refined.push_back(k);
      }
    }
    if (in_step) {
      for (const std::uint32_t k : refined) field.refine_in_step(*surface, scratch.candidates[k]);
    } else {
      field.refine(*surface, scratch);
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
  if (!near.apart && near.clearance < 0.0) return false;
  const voxel::DistanceField& field_a = shapes[bodies.shape[pair.body_a]]->surface.field;
  const voxel::DistanceField& field_b = shapes[bodies.shape[pair.body_b]]->surface.field;
  const double cell = static_cast<double>(std::max(field_a.cell, field_b.cell));
  const double around = bodies.bounding_radius[pair.body_a] + 4.0 * cell + reach;
  const double moved = displacement(near.X_BA, body_pose(bodies, pair), around);
  if (near.clearance >= 0.0) {
    constexpr double kPoseRounding = 2e-3;  // of the poses that were searched [cells]
    return static_cast<double>(FieldContacts::search_margin(reach)) <= near.clear_up_to &&
           reach + moved + kPoseRounding * cell <= near.clearance;
  }
  const float margin = FieldContacts::search_margin(reach);
  return is_still_empty(near.way[0], static_cast<float>(moved), margin, field_b) &&
         is_still_empty(near.way[1], static_cast<float>(moved), margin, field_a);
}

// Keeps few candidates.
void reduce_candidates(const BodyPair& pair, const SearchOptions& options, const PairMotion& motion,
                       SurfaceScratch& scratch) {
  const SlipField slip = motion.slip();
  reduce_contacts(scratch.candidates, remembered(options.memory, pair),
                  {.length = motion.size(),
                   .depth_step = kDepthStep * motion.size(),
                   .reach = motion.rest_reach()},
                  scratch.reduction, options.dt > 0.0 ? &slip : nullptr);
  scratch.reduction_error = std::max(scratch.reduction_error, scratch.reduction.error);
}

// Searches both ways, and learns what may spare the next searches.
void search_and_learn(const BodyState& bodies, const BodyPair& pair, Shapes shapes,
                      const BothWays& ways, const FieldReach& reach, const PairMotion& motion,
                      SurfaceScratch& scratch, NearPair& near) {
  near.apart = false;
  near.clearance = -1.0;
  if (near.distant) {
    near.way[0].forget();
    near.way[1].forget();
    const double cell = static_cast<double>(shapes[bodies.shape[pair.body_a]]->surface.field.cell);
    near.clear_up_to =
        static_cast<double>(FieldContacts::search_margin(reach.searched + kBeyond * cell));
    const double of_a = ways.of_a.append_if_near(reach, near.clear_up_to, motion, scratch);
    const double of_b = ways.of_b.append_if_near(reach, near.clear_up_to, motion, scratch);
    near.clearance = std::min(of_a, of_b);
    near.distant = near.clearance >= 0.0;
  } else {
    ways.of_a.append(reach, motion, &near.way[0], scratch);
    ways.of_b.append(reach, motion, &near.way[1], scratch);
    const auto has_list = [](const NearSamples& way) { return way.margin >= 0.0F; };
    near.apart = std::ranges::all_of(
        near.way, [&](const NearSamples& way) { return has_list(way) && way.packets.empty(); });
    near.distant = scratch.candidates.empty() && std::ranges::none_of(near.way, has_list);
  }
  if (near.apart || near.distant) near.X_BA = body_pose(bodies, pair);
}

// Samples beside a crossing of edges are farther than the crossing: they are searched for up to a
// cell, which is as far as lists of near samples go.
double reach_beside_crossings(const voxel::SurfaceModel& a, const voxel::SurfaceModel& b,
                              double reach) {
  constexpr double kBeside = 0.4;  // of the spacing
  if (a.tree.edges.empty() || b.tree.edges.empty()) return reach;
  const auto cell = static_cast<double>(std::min(a.field.cell, b.field.cell));
  return std::max(reach, std::min(cell, reach + kBeside * std::max(a.spacing, b.spacing)));
}

// Finds the candidates for contacts of two shapes at the present poses, and reduces them if asked
// for.
void find_between_shapes(const BodyState& bodies, const BodyPair& pair, Shapes shapes,
                         ExactSurfaces exact, double kept, const PairMotion& motion,
                         const SearchOptions& options, SurfaceScratch& scratch, NearPair* near) {
  const std::uint32_t shape_a = bodies.shape[pair.body_a];
  const std::uint32_t shape_b = bodies.shape[pair.body_b];
  const bool reduced = options.contacts == model::ContactTreatment::reduced;
  const bool in_step = options.dt > 0.0;
  FieldReach reach{kept, kept, reduced};
  if (reduced && in_step) {
    reach.searched =
        reach_beside_crossings(shapes[shape_a]->surface, shapes[shape_b]->surface, kept);
  }
  if (near != nullptr && is_still_apart(*near, bodies, pair, shapes, reach.searched)) return;
  // Bodies move on the smooth surfaces that their meshes stand for; outside steps meshes decide.
  const BothWays ways(bodies, pair, shapes, in_step ? exact : ExactSurfaces{});
  if (near == nullptr) {
    ways.of_a.append(reach, motion, nullptr, scratch);
    ways.of_b.append(reach, motion, nullptr, scratch);
  } else {
    search_and_learn(bodies, pair, shapes, ways, reach, motion, scratch, *near);
  }
  if (!reduced || scratch.candidates.empty()) return;
  reduce_candidates(pair, options, motion, scratch);
  if (exact.empty()) return;
  refine_kept(ways, exact[shape_a].get(), exact[shape_b].get(), motion.rest_reach(), in_step,
              scratch);
  if (in_step) drop_far_and_twins(scratch.candidates, reach.kept, motion.size(), scratch.reduction);
}

// The same of a shape and a plane or a container.
void find_on_faces(const BodyState& bodies, const BodyPair& pair, Shapes shapes,
                   ExactSurfaces exact, double reach, const PairMotion& motion,
                   const SearchOptions& options, SurfaceScratch& scratch) {
  append_face_contacts(bodies, pair, shapes, options.dt > 0.0 ? exact : ExactSurfaces{}, reach,
                       motion, scratch);
  if (options.contacts == model::ContactTreatment::reduced && !scratch.candidates.empty()) {
    reduce_candidates(pair, options, motion, scratch);
  }
}

// The candidates of a pair at the present poses, reduced if asked for.
void find_candidates(const BodyState& bodies, const BodyPair& pair, Shapes shapes,
                     ExactSurfaces exact, double reach, const PairMotion& motion,
                     const SearchOptions& options, SurfaceScratch& scratch, NearPair* near) {
  scratch.candidates.clear();
  if (bodies.geometry[pair.body_b] == model::Geometry::shape) {
    find_between_shapes(bodies, pair, shapes, exact, reach, motion, options, scratch, near);
  } else {
    find_on_faces(bodies, pair, shapes, exact, reach, motion, options, scratch);
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

// Where friction acts on what slides: of a search in a step, not of its anchors, which outlast the
// slip.
void emit_sliding(const BodyState& bodies, const BodyPair& pair, const SurfaceScratch& scratch,
                  std::uint32_t begin, std::vector<model::SlidingShare>& out) {
  const Reduction& reduction = scratch.reduction;
  if (reduction.sliding.empty()) return;
  const Mat3 R_WA = bodies.q_WB[pair.body_a].toRotationMatrix();
  for (std::uint32_t k = 0; k < reduction.kept.size(); ++k) {
    const ContactCandidate& c = scratch.candidates[reduction.kept[k]];
    const ShareFriction& share = reduction.sliding[k];
    // Like the contact itself, half-way between the bodies.
    const Vec3 origin = bodies.x_W[pair.body_a] - R_WA * ((0.5 * c.gap) * c.normal_A);
    out.push_back({begin + k, share.area, share.alignment, origin + R_WA * share.centre_A,
                   origin + R_WA * share.point_A});
  }
}

}  // namespace

void append_surface_contacts(const BodyState& bodies, const BodyPair& pair, Shapes shapes,
                             ExactSurfaces exact, double margin, const SearchOptions& options,
                             SurfaceScratch& scratch, model::ContactSet& out, NearPair* near) {
  const PairMotion motion(bodies, pair, options.dt);
  find_candidates(bodies, pair, shapes, exact, motion.reach(margin), motion, options, scratch,
                  near);
  if (scratch.candidates.empty()) return;
  const auto begin = static_cast<std::uint32_t>(out.size());
  out.pairs.push_back({pair.body_a, pair.body_b, begin, begin});
  const Mat3 R_WA = bodies.q_WB[pair.body_a].toRotationMatrix();
  const Mat3 R_WB = bodies.q_WB[pair.body_b].toRotationMatrix();
  if (options.contacts == model::ContactTreatment::reduced) {
    for (const std::uint32_t k : scratch.reduction.kept) {
      emit(bodies, pair, scratch.candidates[k], R_WA, R_WB, out);
    }
    emit_sliding(bodies, pair, scratch, begin, out.sliding);
  } else {
    for (const ContactCandidate& c : scratch.candidates) emit(bodies, pair, c, R_WA, R_WB, out);
  }
}

void refresh_anchor(const BodyState& bodies, Shapes shapes, ExactSurfaces exact, double margin,
                    const SearchOptions& options, SurfaceScratch& scratch, NearPair* near,
                    model::ContactAnchors::Pair& anchor,
                    std::vector<model::SlidingShare>& sliding) {
  const BodyPair pair{anchor.body_a, anchor.body_b};
  const PairMotion motion(bodies, pair, options.dt);
  const double needed = motion.reach(margin);
  if (!anchor.contacts.empty() && is_near_anchor(anchor, bodies, motion, needed)) return;
  anchor.contacts.clear();
  const double reach = needed + kAnchorTolerance * motion.size();
  find_candidates(bodies, pair, shapes, exact, reach, motion, options, scratch, near);
  if (scratch.candidates.empty()) return;
  anchor_kept(bodies, reach, scratch, anchor);
  emit_sliding(bodies, pair, scratch, 0, sliding);
}

}  // namespace gotai::collision
