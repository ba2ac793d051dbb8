/// @file
/// Pose files: many poses as CSV, "px,py,pz,qw,qx,qy,qz" [m, unit quaternion].
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "gotai/core/types.h"

namespace gotai::scene {

/// Reads a pose file: lines that start with '#' are comments, one line of column names, then one
/// pose per line. Quaternions are normalised.
/// @throws FileError with line and column for missing columns, bad numbers, zero quaternions
std::vector<Pose> load_poses(const std::string& path);

/// The same for text in memory. @param path for messages
std::vector<Pose> parse_poses(std::string_view text, const std::string& path);

}  // namespace gotai::scene
