/// @file
/// Constants of the bound that prunes the descent. Internal to the surface search; the proof is in
/// surface_search.cpp.
#pragma once

#include <array>
#include <span>

#include "gotai/collision/sample_candidates.h"
#include "gotai/collision/surface_search.h"
#include "gotai/collision/wrench_lanes.h"
#include "gotai/voxel/distance_field.h"
#include "gotai/voxel/triangle_tree.h"

namespace gotai::collision {

/// Rounding of stored values: one fine and one coarse unit are below this for all fields [cells].
inline constexpr float kStoredRounding = 0.02F;

/// Stands for the value of samples that are farther away than any margin [cells].
inline constexpr float kFarBeyond = 1e30F;

/// Largest variance of the lattice nodes around a hit: 3/4 of the squared spacing [cells^2], and a
/// little for rounding.
inline float variance_of_hits(const voxel::DistanceField& field, float margin) {
  constexpr float kFine = 0.751F;
  constexpr float kCoarse = 0.751F * voxel::kCoarseCells * voxel::kCoarseCells;
  return margin < field.nearest_coarse ? kFine : kCoarse;
}

// The AVX2 builds of search_field and search_half_space. Only for processors that have it.
void search_field_avx2(const voxel::SurfaceTree& samples, const voxel::DistanceField& field,
                       const SamplePose& pose, SearchReach reach, SurfaceSearch& search);
void search_field_widely_avx2(const voxel::SurfaceTree& samples, const voxel::DistanceField& field,
                              const SamplePose& pose, SearchReach reach, float wide,
                              SurfaceSearch& search);
void search_packets_avx2(const voxel::SurfaceTree& samples, const voxel::DistanceField& field,
                         const SamplePose& pose, SearchReach reach,
                         const std::vector<std::uint32_t>& packets, SurfaceSearch& search);
void search_half_space_avx2(const voxel::SurfaceTree& samples, const std::array<float, 3>& normal,
                            float offset, float margin, SurfaceSearch& search);
// Likewise of nearest_triangle.
std::uint32_t nearest_triangle_avx2(const voxel::TriangleTree& tree,
                                    const std::array<float, 3>& point, float limit);
// Of make_candidates and look_up_distances.
void make_candidates_avx2(const NearSurface& near, float margin, const Closing& closing,
                          const HitLanes* hits, std::size_t packets, CandidateLanes* out);
void look_up_distances_avx2(const voxel::DistanceField& field, const SamplePose& pose, float margin,
                            std::span<const std::array<float, 3>> points,
                            std::span<float> distances);
// And of keep_wrench.
FarthestWrench keep_wrench_avx2(WrenchLanes& lanes, std::uint32_t chosen, std::uint32_t position,
                                float same);

}  // namespace gotai::collision
