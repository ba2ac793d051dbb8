/// @file
/// Drops the keys of an animation that interpolation between the others brings back. Internal to
/// the module.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "gotai/core/types.h"

namespace gotai::recording {

/// Indices of the positions to keep, first and last included (only the first when nothing moves):
/// linear interpolation over time between them is within `tolerance` [m] of every position.
std::vector<std::size_t> thin_positions(const std::vector<double>& times,
                                        const std::vector<Vec3>& positions, double tolerance);

/// The same for rotations: great-arc interpolation is within `tolerance` [rad] of every one.
/// @param rotations  neighbours on the same half sphere (dot product >= 0)
std::vector<std::size_t> thin_rotations(const std::vector<double>& times,
                                        const std::vector<Quat>& rotations, double tolerance);

}  // namespace gotai::recording
