/// @file
/// Impulses that contacts carry from step to step.
#pragma once

#include <vector>

#include "gotai/model/contact_memory.h"
#include "gotai/model/contact_set.h"

namespace gotai::impulse {

/// Impulse of the last step per contact [N s], W; zero for contacts that are new.
void recall(const model::ContactMemory& memory, const model::ContactSet& contacts,
            std::vector<Vec3>& impulse_W);

/// Replaces the memory by the contacts that carried an impulse.
/// @param impulse_W  per contact [N s], W
void remember(const model::ContactSet& contacts, const std::vector<Vec3>& impulse_W,
              model::ContactMemory& memory);

}  // namespace gotai::impulse
