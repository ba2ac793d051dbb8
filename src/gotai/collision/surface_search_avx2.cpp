// The same search with AVX2 instructions. Only functions below the pragma may use them, and they
// call nothing that other files share.
#ifdef __x86_64__

#include <immintrin.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

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
#define GOTAI_INLINE inline __attribute__((always_inline))

namespace gotai::collision::avx2 {

GOTAI_INLINE unsigned mask_of(I8 lanes) {
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps((__m256i)lanes)));
}

GOTAI_INLINE I8 gather(const std::int32_t* values, I8 index) {
  return (I8)_mm256_i32gather_epi32(values, (__m256i)index, 4);
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

// values[index] and values[index + 1] of every lane, in one 32-bit gather.
GOTAI_INLINE void gather_pairs(const std::int16_t* values, I8 index, F8& first, F8& second) {
  const auto* base = reinterpret_cast<const int*>(values);
  const I8 both = (I8)_mm256_i32gather_epi32(base, (__m256i)index, 2);
  first = __builtin_convertvector((both << 16) >> 16, F8);
  second = __builtin_convertvector(both >> 16, F8);
}

GOTAI_INLINE F8 root(F8 x) { return (F8)_mm256_sqrt_ps((__m256)x); }

}  // namespace gotai::collision::avx2

#include "gotai/collision/surface_search_kernel.inc"
#include "gotai/collision/triangle_search_kernel.inc"

#include "gotai/collision/candidate_kernel.inc"

#include "gotai/collision/reduction_kernel.inc"

namespace gotai::collision {

void search_field_avx2(const voxel::SurfaceTree& samples, const voxel::DistanceField& field,
                       const SamplePose& pose, SearchReach reach, SurfaceSearch& search) {
  avx2::search_field<false>(samples, field, pose, reach, reach.margin, search);
}

void search_field_widely_avx2(const voxel::SurfaceTree& samples, const voxel::DistanceField& field,
                              const SamplePose& pose, SearchReach reach, float wide,
                              SurfaceSearch& search) {
  avx2::search_field<true>(samples, field, pose, reach, wide, search);
}

void search_packets_avx2(const voxel::SurfaceTree& samples, const voxel::DistanceField& field,
                         const SamplePose& pose, SearchReach reach,
                         const std::vector<std::uint32_t>& packets, SurfaceSearch& search) {
  avx2::search_packets(samples, field, pose, reach, packets, search);
}

void search_half_space_avx2(const voxel::SurfaceTree& samples, const std::array<float, 3>& normal,
                            float offset, float margin, SurfaceSearch& search) {
  avx2::search_half_space(samples, normal, offset, margin, search);
}

std::uint32_t nearest_triangle_avx2(const voxel::TriangleTree& tree,
                                    const std::array<float, 3>& point, float limit) {
  return avx2::nearest_triangle(tree, point, limit);
}

void make_candidates_avx2(const NearSurface& near, float margin, const Closing& closing,
                          const HitLanes* hits, std::size_t packets, CandidateLanes* out) {
  avx2::make_candidates(near, margin, closing, hits, packets, out);
}

void look_up_distances_avx2(const voxel::DistanceField& field, const SamplePose& pose, float margin,
                            std::span<const std::array<float, 3>> points,
                            std::span<float> distances) {
  avx2::look_up_distances(field, pose, margin, points.data(), points.size(), distances.data());
}

FarthestWrench keep_wrench_avx2(WrenchLanes& lanes, std::uint32_t chosen, std::uint32_t position,
                                float same) {
  return avx2::keep_wrench(lanes, chosen, position, same);
}

}  // namespace gotai::collision

#ifdef __clang__
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif

#endif
