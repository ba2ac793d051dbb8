// The same search with AVX-512 instructions, on eight lanes as well: masks have registers of their
// own. Only functions below the pragma may use them, and they call nothing that other files share.
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
#pragma clang attribute push(__attribute__((target("avx2,avx512f,avx512vl,avx512dq,avx512bw"))), \
                             apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2,avx512f,avx512vl,avx512dq,avx512bw")
#endif

#define GOTAI_KERNEL avx512

namespace gotai::collision::avx512 {

GOTAI_INLINE unsigned mask_of(I8 lanes) { return _mm256_movepi32_mask((__m256i)lanes); }

// Writes first + lane for every lane of a mask; eight values are written.
GOTAI_INLINE void store_lanes(unsigned mask, std::uint32_t first, std::uint32_t* to) {
  const __m256i lanes = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
  const __m256i values = _mm256_add_epi32(lanes, _mm256_set1_epi32(static_cast<int>(first)));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(to),
                      _mm256_maskz_compress_epi32(static_cast<__mmask8>(mask), values));
}

}  // namespace gotai::collision::avx512

#include "gotai/collision/x86_lanes.inc"

#include "gotai/collision/kernels.inc"

namespace gotai::collision {

const KernelTable kAvx512Kernels = avx512::kTable;

}  // namespace gotai::collision

#ifdef __clang__
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif

#endif
