/// @file
/// Constants of the bound that prunes the descent. Internal to the surface search; the proof is in
/// surface_search.cpp.
#pragma once

#include "gotai/voxel/distance_field.h"

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

}  // namespace gotai::collision
