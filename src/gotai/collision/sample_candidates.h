/// @file
/// From samples that are near another surface to candidates for contacts, eight at a time: the
/// normal that a sample and the field agree on, the place on a curved surface, the area that
/// counts. All instruction sets give the same bits.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "gotai/collision/curved_samples.h"
#include "gotai/collision/pair_motion.h"
#include "gotai/collision/reduction.h"
#include "gotai/collision/surface_search.h"
#include "gotai/voxel/surface_model.h"
#include "gotai/voxel/surface_samples.h"

namespace gotai::collision {

/// Key of a contact: which of the two bodies the sample is on (0: body_a, 1: body_b), or for planes
/// and containers which face it meets (floor 0, walls 1..4), and the sample.
constexpr model::FeatureKey surface_feature(std::uint32_t direction, std::uint32_t sample) {
  return static_cast<model::FeatureKey>(direction) << 32U | sample;
}

/// Where an edge crosses another, the nearer of the two samples beside it is no farther along the
/// edge than this many spacings.
inline constexpr double kEdgeShare = 0.5 * voxel::kEdgeSpacing;

/// Fields round edges off: near those the triangles may be nearer by this [cells].
inline constexpr double kEdgeRounding = 0.4;

/// The samples of a body P near a body Q, of which one is body a of the pair.
struct NearSurface {
  const voxel::SurfaceModel& samples;  ///< of P
  const voxel::DistanceField& field;   ///< of Q
  const CurvedSamples* curved;         ///< of P; null: samples stay where they are
  SamplePose pose;                     ///< from P's frame S to Q's
  std::array<double, 9> rotation_AP;   ///< from P's axes to those of body a, row by row
  std::array<double, 3> origin_A;      ///< of P's frame S, from a's centre of mass [m], A
  bool samples_of_b = false;           ///< P is body b of the pair
  float kept = std::numeric_limits<float>::infinity();  ///< largest gap of a candidate [m]
  float beside = 0.0F;  ///< samples with gaps up to this move to where edges cross [m]
};

/// What the kernel reads of eight hits and their samples. Frame S of P.
struct alignas(32) HitLanes {
  using Lanes = std::array<float, voxel::kLanes>;
  std::array<Lanes, 3> point;                      ///< of the sample [m]
  Lanes distance;                                  ///< in Q's field [m]
  std::array<Lanes, 3> gradient;                   ///< of Q's field, in Q's frame
  std::array<Lanes, 3> axis;                       ///< of the normal cone, unit
  Lanes cosine;                                    ///< of its half angle
  std::array<Lanes, 3> along;                      ///< the edge of an edge's sample, unit; else 0
  Lanes reach_back, reach_forward;                 ///< along it [m]
  std::array<Lanes, 3> area;                       ///< integral of the outward normal [m^2]
  Lanes bulge;                                     ///< 1: the surface is curved there; else 0
  std::array<Lanes, 3> bulge_point, bulge_normal;  ///< of CurvedSample
  std::array<std::array<Lanes, 3>, 2> bulge_direction;  ///< likewise
  std::array<Lanes, 2> bulge_curvature;                 ///< likewise
  bool any_edge, any_bulge;
};

/// What becomes of eight hits. Frame A: axes of body a, origin at its centre of mass.
struct alignas(64) CandidateLanes {
  using Wide = std::array<double, voxel::kLanes>;
  std::array<Wide, 3> point;   ///< on body a [m]
  std::array<Wide, 3> normal;  ///< from b to a, unit to single precision
  std::array<float, voxel::kLanes> gap, area;
  std::uint32_t counts;   ///< mask of the lanes that are candidates
  std::uint32_t crosses;  ///< mask of the lanes where edges cross
  std::uint32_t rough;    ///< mask of the lanes where the field is not smooth
};

/// Storage.
struct CandidateScratch {
  std::vector<HitLanes> hits;
  std::vector<CandidateLanes> candidates;
};

/// The kernel of append_candidates.
/// @param hits     what was collected of `packets` times eight hits
/// @param[out] out as many
void make_candidates(const NearSurface& near, float margin, const Closing& closing,
                     const HitLanes* hits, std::size_t packets, CandidateLanes* out,
                     Kernel kernel = Kernel::automatic);

/// Appends the hits that may become contacts within the step: their samples face Q, and they may
/// close in time.
/// @param margin  of the search that found the hits [m]
void append_candidates(const NearSurface& near, std::span<const SurfaceHit> hits, float margin,
                       const Closing& closing, CandidateScratch& scratch,
                       std::vector<ContactCandidate>& out, Kernel kernel = Kernel::automatic);

/// Q's field at a point of P.
struct FieldAtPoint {
  float distance;              ///< [m]
  std::array<float, 3> slope;  ///< of the field, in P's axes
};

/// Q's field at points of P [m]; what is above `margin` may be any value above it.
/// @param points  frame S of P [m]
void look_up_field(const voxel::DistanceField& field, const SamplePose& pose, float margin,
                   std::span<const std::array<float, 3>> points, std::span<FieldAtPoint> values,
                   Kernel kernel = Kernel::automatic);

}  // namespace gotai::collision
