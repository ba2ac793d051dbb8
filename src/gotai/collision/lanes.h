/// @file
/// Eight floats or integers at a time, as compiler vectors: operators work lane by lane and compile
/// to whatever instructions the enclosing function may use. No fused multiply-add, no reordered
/// sums: every instruction set gives the same bits.
#pragma once

#include <cstdint>
#include <cstring>

// Whatever the compiler would choose: vectors must not be passed between functions.
#define GOTAI_INLINE inline __attribute__((always_inline))

namespace gotai::collision {

inline constexpr int kLanes = 8;

using F8 = float __attribute__((vector_size(32)));
using I8 = std::int32_t __attribute__((vector_size(32)));

}  // namespace gotai::collision
