/// @file
/// The order of the leaves of 8-ary trees without pointers. Internal to the voxel module.
#pragma once

#include <cstdint>
#include <vector>

#include "gotai/core/types.h"

namespace gotai::voxel {

/// Orders points so that every aligned run of 8^k of them is compact: halves along the longest
/// axis, cut at multiples of the largest power of 8 that fits.
/// @return indices into points
std::vector<std::uint32_t> order_in_runs(const std::vector<Vec3>& points);

}  // namespace gotai::voxel
