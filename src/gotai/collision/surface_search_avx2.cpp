// The same search with AVX2 instructions. Only functions below the pragma may use them, and they
// call nothing that other files share.
#ifdef __x86_64__

#include <immintrin.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "gotai/collision/kernels.h"
#include "gotai/collision/lanes.h"
#include "gotai/collision/surface_search.h"
#include "gotai/collision/surface_search_bounds.h"

#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2")
#endif

#define GOTAI_KERNEL avx2

namespace gotai::collision::avx2 {

GOTAI_INLINE unsigned mask_of(I8 lanes) {
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps((__m256i)lanes)));
}

// The lanes of every mask, one per byte.
struct LaneTable {
  std::uint64_t lanes[256] = {};

  constexpr LaneTable() {
    for (unsigned mask = 0; mask < 256; ++mask) {
      unsigned at = 0;
      for (unsigned lane = 0; lane < 8; ++lane) {
        if ((mask >> lane & 1U) != 0U) lanes[mask] |= std::uint64_t{lane} << (8 * at++);
      }
    }
  }
};
constexpr LaneTable kLaneTable;

// Writes first + lane for every lane of a mask; eight values are written.
GOTAI_INLINE void store_lanes(unsigned mask, std::uint32_t first, std::uint32_t* to) {
  const __m128i bytes = _mm_cvtsi64_si128(static_cast<long long>(kLaneTable.lanes[mask]));
  const __m256i lanes = _mm256_cvtepu8_epi32(bytes);
  const __m256i values = _mm256_add_epi32(lanes, _mm256_set1_epi32(static_cast<int>(first)));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), values);
}

}  // namespace gotai::collision::avx2

#include "gotai/collision/x86_lanes.inc"

#include "gotai/collision/kernels.inc"

namespace gotai::collision {

const KernelTable kAvx2Kernels = avx2::kTable;

}  // namespace gotai::collision

#ifdef __clang__
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif

#endif
