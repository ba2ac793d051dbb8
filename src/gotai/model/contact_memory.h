/// @file
/// What contacts remember from step to step. State: saved and hashed, because a warm start changes
/// bits.
#pragma once

#include <vector>

#include "gotai/core/types.h"
#include "gotai/model/contact_set.h"

namespace gotai::model {

/// Impulses of the last step, by contact key. Sorted by (body_a, body_b, feature).
/// Written by the impulse method at the end of a step.
struct ContactMemory {
  struct Entry {
    BodyIndex body_a = 0;
    BodyIndex body_b = 0;
    FeatureKey feature = 0;
    Vec3 impulse_W = Vec3::Zero();  ///< on body a, summed over the step [N s], W
  };
  std::vector<Entry> entries;
};

}  // namespace gotai::model
