/// @file
/// Vectors in single precision, as files keep them. Internal to the module.
#pragma once

#include <vector>

#include "gotai/core/types.h"

namespace gotai::recording {

/// Appends the three components.
inline void push(std::vector<float>& out, const Vec3& v) {
  for (int k = 0; k < 3; ++k) out.push_back(static_cast<float>(v[k]));
}

}  // namespace gotai::recording
