/// @file
/// The samples of one shape in the distance field of another: the candidates for contacts that they
/// are, and their distances to the true surface.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "gotai/collision/broad_phase.h"
#include "gotai/collision/exact_surface.h"
#include "gotai/collision/near_samples.h"
#include "gotai/collision/pair_motion.h"
#include "gotai/collision/reduction.h"
#include "gotai/collision/sample_candidates.h"
#include "gotai/collision/surface_search.h"
#include "gotai/model/body_state.h"
#include "gotai/voxel/shape.h"

namespace gotai::collision {

/// Candidates that are measured to triangles, and the mesh's vertices around their samples.
struct RefinementScratch {
  std::vector<std::uint32_t> candidates;       ///< which, of one body's samples
  std::vector<std::array<float, 3>> vertices;  ///< of all of them, in their order [m], frame S
  std::vector<std::size_t> vertices_end;       ///< by candidate
  std::vector<FieldAtPoint> values;            ///< of the other body's field at the vertices
};

/// Storage of the search for one pair after another.
struct SurfaceScratch {
  SurfaceSearch search;
  CandidateScratch lanes;
  std::vector<ContactCandidate> candidates;
  Reduction reduction;
  RefinementScratch refinement;
  double reduction_error = 0.0;  ///< largest Reduction::error so far
};

/// How far contacts are looked for.
struct FieldReach {
  double kept;  ///< largest gap of a candidate [m]
  /// Largest distance of a sample, >= kept: beside a crossing of edges they are farther apart [m].
  double searched;
  /// Contacts get reduced: of samples that are far away one in each packet is enough, and samples
  /// of edges move to where they cross Q's.
  bool reduced;
};

/// Samples of one body of a pair, P, in the field of the other, Q, at the present poses.
class FieldContacts {
 public:
  /// @param shapes  indexed by BodyState::shape, with surface models
  /// @param smooth  likewise, for steps: samples slide on curved surfaces and, where Q's triangles
  ///                are known, to crossings of edges; empty: they stay where they are
  /// @param X_QP    P's mesh frame in Q's
  FieldContacts(const model::BodyState& bodies, const BodyPair& pair,
                std::span<const std::shared_ptr<const voxel::Shape>> shapes, ExactSurfaces smooth,
                bool samples_of_b, const Pose& X_QP);

  /// Largest float that is not above the margin, so that searches keep the promise of the margin.
  static float search_margin(double margin);

  /// Appends to scratch.candidates the samples near Q that may become contacts.
  /// @param near  of the last search, or null
  void append(const FieldReach& reach, const PairMotion& motion, NearSamples* near,
              SurfaceScratch& scratch) const;
  /// The same for bodies that are probably farther apart than `wide` [m], a float >= what is
  /// searched.
  /// @return how far apart they are: SurfaceSearch::clearance [m]
  double append_if_near(const FieldReach& reach, double wide, const PairMotion& motion,
                        SurfaceScratch& scratch) const;

  /// By how much Q's field may overestimate distances near edges [m].
  double rounding() const { return kEdgeRounding * static_cast<double>(field_.field.cell); }

  /// Replaces gaps and normals of scratch.refinement.candidates by those of Q's triangles. A sample
  /// of a face first gives way to the deepest of the mesh's vertices around it. A sample of an edge
  /// slides to where its edge is nearest, if that is between it and its neighbours: with flat faces
  /// on both sides of the nearest point, where the two lines of the distance along the edge cross.
  /// The normal remains the field's where the nearest point is on an edge: there the field's is a
  /// mean that does not jump.
  void refine(const ExactSurface& exact, SurfaceScratch& scratch) const;

  /// Replaces the gap by the distance to Q's triangles, for contacts that push in a step: of the
  /// sample itself or, where its edge passes over an edge of Q, of where the edges cross, with
  /// their common normal. Nothing jumps when bodies rock: faces are not followed, and an edge that
  /// is nearly parallel to a face only in part (kSteep), since else piles never rest.
  void refine_in_step(const ExactSurface& exact, ContactCandidate& c) const;

 private:
  // A point of P in Q's field.
  struct FieldPoint {
    Vec3 x_P;
    double distance;
  };
  // Distance of a point of P to Q's triangles after sliding along its edge, and how it changes.
  struct Slid;

  SearchReach search_reach(const FieldReach& reach, const PairMotion& motion) const;
  float beside_crossings(const FieldReach& reach, const PairMotion& motion) const;
  void append_hits(const FieldReach& reach, const PairMotion& motion,
                   SurfaceScratch& scratch) const;
  void look_up_vertices(SurfaceScratch& scratch) const;
  void refine_from(const FieldPoint& own, const ExactSurface& exact, ContactCandidate& c) const;
  bool rises_at(const Vec3& x_P, const Vec3& along_P) const;
  void refine_crossing(const ExactSurface& exact, const Vec3& own_Q, ContactCandidate& c) const;
  void put_at(const Vec3& x_P, ContactCandidate& c) const;
  // @param expected  probably no farther [m]
  Slid slide(const ExactSurface& exact, const Vec3& own_P, const Vec3& edge_P, double along,
             double limit, double expected) const;

  bool samples_of_b_;
  Vec3 p_MA_;
  const voxel::SurfaceModel& samples_;
  const voxel::SurfaceModel& field_;
  Pose X_QP_;  // P's mesh frame in Q's
  Mat3 R_QP_;
  SamplePose pose_;
  const CurvedSamples* curved_ = nullptr;  // of P
  bool is_exact_ = false;                  // Q's triangles are at hand
};

}  // namespace gotai::collision
