#include "gotai/collision/surface_search.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "gotai/collision/exact_surface.h"
#include "gotai/collision/kernels.h"
#include "gotai/collision/lanes.h"
#include "gotai/collision/surface_search_bounds.h"
#include "gotai/core/instruction_set.h"

// Why pruning loses nothing. Let f be the value that a sample gets: I(x), the interpolation of the
// fine lattice (spacing c), where a brick holds it, else I_c(x) of the coarse lattice (spacing 4c),
// kept at least `nearest_coarse` from 0 on the side that the brick table knows. All lattices hold
// the distance phi, or phi clamped, at their nodes: both change by at most |x - y| between x and y.
//
// Let m be the centre of a sphere of radius r that contains the sample x; w_i and w_j the weights
// of the nodes x_i around x and m_j around m. Since sum w_i x_i = x (likewise m),
//   I(m) - I(x) = sum_ij w_i w_j (phi(m_j) - phi(x_i)) <= sum_ij w_i w_j |m_j - x_i|
//     <= sqrt(sum_ij w_i w_j |m_j - x_i|^2) = sqrt(|m - x|^2 + V(m) + V(x)),
// by Jensen; V(x) = sum_i w_i |x_i - x|^2 = s^2 sum t (1 - t) <= 3/4 s^2 for spacing s. So
//   f(x) <= margin  implies  I(m) - margin <= sqrt(r^2 + V(m) + 3/4 s_x^2).
// The clamp of coarse values keeps it: raised values stay >= I_c(x), and lowered ones are >=
// phi(x). A sample that uses the coarse lattice and is a hit lies inside, at phi(x) <=
// -nearest_coarse, unless margin >= nearest_coarse; then I(m) - phi(x) <= sqrt(r^2 + V(m)),
// likewise, keeps the sphere anyway. So s_x = c is enough for margins below nearest_coarse. Centres
// have their values from the coarse lattice, s_m = 4c: the fine one's would spare few packets (and
// where bricks clamp them none), but take longer to look up than those packets.
//
// Beyond the lattice's cube, with x' the nearest point of the cube, f(x) = f(x') + |x - x'|. Then
// f(x) >= f(x'), and |x' - m'| <= |x - m|, so the bound holds with I(m'). The cube's faces are four
// cells from the shape, so f(x') > 0 and a hit has |x - x'| <= margin; hence |m - m'| <= r +
// margin.
//
// Clearance. A sample of that sphere that has moved by up to d since is within r + d of m, so all
// of this holds of where it is now with r + d for r. With S = V(m) + 3/4 s_x^2 (for a margin
// up to `wide`, by which s_x is chosen),
//   f >= I(m) - sqrt((r + d)^2 + S) >= I(m) - sqrt(r^2 + S) - d   where that is at most `wide`;
// beyond the cube f exceeds the distance to the cube, which is at least |m - m'| - r - d.

#define GOTAI_KERNEL portable

namespace gotai::collision::portable {

GOTAI_INLINE unsigned mask_of(I8 lanes) {
  unsigned mask = 0;
  for (int i = 0; i < kLanes; ++i) mask |= (static_cast<unsigned>(lanes[i]) >> 31U) << i;
  return mask;
}

GOTAI_INLINE I8 gather(const std::int32_t* values, I8 index) {
  I8 result;
  for (int i = 0; i < kLanes; ++i) result[i] = values[index[i]];
  return result;
}

// Writes first + lane for every lane of a mask; eight values may be written.
GOTAI_INLINE void store_lanes(unsigned mask, std::uint32_t first, std::uint32_t* to) {
  for (; mask != 0U; mask &= mask - 1U) {
    *to++ = first + static_cast<std::uint32_t>(__builtin_ctz(mask));
  }
}

// values[index] and values[index + 1] of every lane.
GOTAI_INLINE void gather_pairs(const std::int16_t* values, I8 index, F8& first, F8& second) {
  for (int i = 0; i < kLanes; ++i) {
    first[i] = static_cast<float>(values[index[i]]);
    second[i] = static_cast<float>(values[index[i] + 1]);
  }
}

// The 32 bits from values[index] on of every lane.
GOTAI_INLINE I8 gather_bits(const std::uint8_t* values, I8 index) {
  I8 result;
  for (int i = 0; i < kLanes; ++i) {
    std::int32_t bits;
    std::memcpy(&bits, values + index[i], sizeof(bits));
    result[i] = bits;
  }
  return result;
}

GOTAI_INLINE F8 root(F8 x) {
  for (int i = 0; i < kLanes; ++i) x[i] = __builtin_sqrtf(x[i]);
  return x;
}

}  // namespace gotai::collision::portable

#include "gotai/collision/kernels.inc"

namespace gotai::collision {
namespace {

Kernel fastest_kernel() {
  const Instructions wanted = wanted_instructions();
  if (wanted == Instructions::best && is_available(Kernel::avx512)) return Kernel::avx512;
  if (wanted != Instructions::portable && is_available(Kernel::avx2)) return Kernel::avx2;
  return Kernel::portable;
}

const KernelTable& table_of(Kernel kernel) {
  static const Kernel fastest = fastest_kernel();
#ifdef __x86_64__
  switch (kernel == Kernel::automatic ? fastest : kernel) {
    case Kernel::avx512:
      return kAvx512Kernels;
    case Kernel::avx2:
      return kAvx2Kernels;
    default:
      break;
  }
#endif
  return portable::kTable;
}

}  // namespace

SamplePose make_sample_pose(const Mat3& R, const Vec3& t) {
  using Rows = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;
  SamplePose pose{};
  Eigen::Map<Rows>(pose.rotation.data()) = R.cast<float>();
  Eigen::Map<Eigen::Vector3f>(pose.translation.data()) = t.cast<float>();
  return pose;
}

bool is_available(Kernel kernel) {
#ifdef __x86_64__
  const bool has_avx2 = __builtin_cpu_supports("avx2") != 0;
  const auto has_all_avx512 = [] {
    return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512vl") != 0 &&
           __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512bw") != 0;
  };
#else
  const bool has_avx2 = false;
  const auto has_all_avx512 = [] { return false; };
#endif
  switch (kernel) {
    case Kernel::avx2:
      return has_avx2;
    case Kernel::avx512:
      return has_avx2 && has_all_avx512();
    default:
      return true;
  }
}

void search_field(const voxel::SurfaceTree& samples, const voxel::DistanceField& field,
                  const SamplePose& pose, SearchReach reach, SurfaceSearch& search, Kernel kernel) {
  table_of(kernel).search_field(samples, field, pose, reach, search);
}

void search_field_widely(const voxel::SurfaceTree& samples, const voxel::DistanceField& field,
                         const SamplePose& pose, SearchReach reach, float wide,
                         SurfaceSearch& search, Kernel kernel) {
  table_of(kernel).search_field_widely(samples, field, pose, reach, wide, search);
}

void search_and_list(const voxel::SurfaceTree& samples, const voxel::DistanceField& field,
                     const SamplePose& pose, SearchReach reach, float wide, SurfaceSearch& search,
                     std::vector<std::uint32_t>& list, Kernel kernel) {
  table_of(kernel).search_and_list(samples, field, pose, reach, wide, search, list);
}

void search_packets(const voxel::SurfaceTree& samples, const voxel::DistanceField& field,
                    const SamplePose& pose, SearchReach reach,
                    const std::vector<std::uint32_t>& packets, SurfaceSearch& search,
                    Kernel kernel) {
  table_of(kernel).search_packets(samples, field, pose, reach, packets, search);
}

void search_half_space(const voxel::SurfaceTree& samples, const std::array<float, 3>& normal,
                       float offset, float margin, SurfaceSearch& search, Kernel kernel) {
  table_of(kernel).search_half_space(samples, normal, offset, margin, search);
}

std::uint32_t nearest_triangle(const voxel::TriangleTree& tree, const std::array<float, 3>& point,
                               float limit, Kernel kernel) {
  return table_of(kernel).nearest_triangle(tree, point, limit);
}

void make_candidates(const NearSurface& near, float margin, const Closing& closing,
                     const HitLanes* hits, std::size_t packets, CandidateLanes* out,
                     Kernel kernel) {
  table_of(kernel).make_candidates(near, margin, closing, hits, packets, out);
}

void look_up_field(const voxel::DistanceField& field, const SamplePose& pose, float margin,
                   std::span<const std::array<float, 3>> points, std::span<FieldAtPoint> values,
                   Kernel kernel) {
  table_of(kernel).look_up_field(field, pose, margin, points, values);
}

FarthestWrench keep_wrench(WrenchLanes& lanes, std::uint32_t chosen, std::uint32_t position,
                           float same, Kernel kernel) {
  return table_of(kernel).keep_wrench(lanes, chosen, position, same);
}

}  // namespace gotai::collision
