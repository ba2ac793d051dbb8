/// @file
/// How far the true meshes of a world overlap, whatever the collision model believes.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "gotai/model/body_state.h"
#include "gotai/voxel/shape.h"

namespace gotai {

/// Overlaps of the meshes as given, over all pairs that touch (gap below 0.1 %): bodies with
/// bodies, and bodies with each face of planes and containers. Lengths are fractions of the
/// diagonal of the smaller body's bounding box; gaps count as overlap 0.
struct TrueOverlap {
  std::uint64_t touching = 0;  ///< pairs
  double mean = 0.0;
  double p99 = 0.0;  ///< 99th percentile
  double max = 0.0;
  double max_m = 0.0;  ///< the largest overlap [m]
  /// Median over the dynamic bodies of the gap to the third nearest neighbour or face, negative
  /// when they overlap: about 0 when bodies truly touch. Bodies with fewer than three neighbours
  /// within 5 % do not count.
  double gap3 = 0.0;
};

/// Exact distances to the triangles of one body from the vertices of the other and from its edges
/// (sampled every 1 % of the diagonal, then followed to the deepest point), both ways. Independent
/// of the collision models; slow, spread over the threads, the same for any number of them.
/// @param shapes  indexed by BodyState::shape
TrueOverlap measure_true_overlap(const model::BodyState& bodies,
                                 std::span<const std::shared_ptr<const voxel::Shape>> shapes);

}  // namespace gotai
