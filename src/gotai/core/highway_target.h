/// @file
/// Which of Highway's instruction sets kernels run on.
#pragma once

#include <hwy/targets.h>

#include <cstdint>

#include "gotai/core/instruction_set.h"

namespace gotai {

/// Keeps Highway to what wanted_instructions() allows. To be called before every dynamic dispatch:
/// the first one in the program chooses for all.
inline void choose_highway_target() {
  static const bool chosen = [] {
    const Instructions wanted = wanted_instructions();
    if (wanted == Instructions::portable) hwy::DisableTargets(~std::int64_t{HWY_STATIC_TARGET});
    if (wanted == Instructions::avx2) hwy::DisableTargets(HWY_AVX2 - 1);  // all that are better
    return true;
  }();
  static_cast<void>(chosen);
}

}  // namespace gotai
