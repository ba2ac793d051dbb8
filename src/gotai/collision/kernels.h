/// @file
/// The inner loops of the surface search, once per instruction set: all give the same bits.
/// Internal to the surface search.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "gotai/collision/sample_candidates.h"
#include "gotai/collision/surface_search.h"
#include "gotai/collision/wrench_lanes.h"
#include "gotai/voxel/distance_field.h"
#include "gotai/voxel/surface_model.h"
#include "gotai/voxel/triangle_tree.h"

namespace gotai::collision {

/// What an instruction set compiles, under the names of the functions that call it.
struct KernelTable {
  void (*search_field)(const voxel::SurfaceTree& samples, const voxel::DistanceField& field,
                       const SamplePose& pose, const SearchReach& reach, SurfaceSearch& search);
  void (*search_field_widely)(const voxel::SurfaceTree& samples, const voxel::DistanceField& field,
                              const SamplePose& pose, const SearchReach& reach, float wide,
                              SurfaceSearch& search);
  void (*search_and_list)(const voxel::SurfaceTree& samples, const voxel::DistanceField& field,
                          const SamplePose& pose, const SearchReach& reach, float wide,
                          SurfaceSearch& search, std::vector<std::uint32_t>& list);
  void (*search_packets)(const voxel::SurfaceTree& samples, const voxel::DistanceField& field,
                         const SamplePose& pose, const SearchReach& reach,
                         const std::vector<std::uint32_t>& packets, SurfaceSearch& search);
  void (*search_half_space)(const voxel::SurfaceTree& samples, const std::array<float, 3>& normal,
                            float offset, float margin, SurfaceSearch& search);
  std::uint32_t (*nearest_triangle)(const voxel::TriangleTree& tree,
                                    const std::array<float, 3>& point, float limit);
  void (*make_candidates)(const NearSurface& near, float margin, const Closing& closing,
                          const HitLanes* hits, std::size_t packets, CandidateLanes* out);
  void (*look_up_field)(const voxel::DistanceField& field, const SamplePose& pose, float margin,
                        std::span<const std::array<float, 3>> points,
                        std::span<FieldAtPoint> values);
  FarthestWrench (*keep_wrench)(WrenchLanes& lanes, std::uint32_t chosen, std::uint32_t position,
                                float same);
};

#ifdef __x86_64__
// Only for processors that have the instructions.
extern const KernelTable kAvx2Kernels;
extern const KernelTable kAvx512Kernels;
#endif

}  // namespace gotai::collision
