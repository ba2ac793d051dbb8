/// @file
/// Sphere by sphere, level by level: the thesis's collision detection [Makino 2007, section 3.2.3,
/// Figs. 3-5, 3-6], in the reading of errata 13 and 14.
///
/// Each voxel stands for its circumscribed sphere. If the level-1 spheres of two bodies overlap,
/// d <= r_1 + r_2, their level-2 spheres are tested, every colliding sphere is replaced by its
/// children, and so on to level k. What still overlaps at level k is the result.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gotai/collision/sphere_tree.h"
#include "gotai/core/types.h"

namespace gotai::collision {

/// Sphere-sphere (or sphere-plane) tests per level: tests[h - 1] at level h.
using TestCounts = std::array<std::uint64_t, voxel::kMaxLevel>;

/// Two spheres of the finest level that overlap or are nearer than the margin.
struct SphereOverlap {
  std::uint32_t a = 0;    ///< voxel of body a, index in its level
  std::uint32_t b = 0;    ///< voxel of body b
  Vec3 c_A;               ///< centre of a's sphere in the mesh frame of b [m]
  double distance = 0.0;  ///< between the centres [m]
};

/// Pairs of spheres that the descent holds between two levels. Reused; not state.
class DescentScratch {
 public:
  using Float4 = float __attribute__((vector_size(16)));
  /// Difference of two centres c_A - c_B [m], b's mesh frame: x, y, z, 0.
  struct Difference {
    Float4 d;
  };
  /// All pairs of one voxel of a: entries [begin, end).
  struct Group {
    std::uint32_t a, begin, end;
  };
  struct Frontier {
    std::vector<Group> groups;  // the first group_count are in use
    // One entry per pair of voxels; the first entry_count are in use.
    std::vector<Difference> difference;
    std::vector<std::uint32_t> b;  // b's voxel
    std::uint32_t group_count = 0;
    std::uint32_t entry_count = 0;
  };
  Frontier current;
  Frontier next;
};

/// Descends two pyramids together to level k and returns the overlapping spheres of that level.
///
/// The last level is decided in double precision by d - (r_A + r_B) <= margin. The coarser levels
/// only prune: in single precision with radii inflated by more than its rounding error, so that the
/// result is that of testing every pair of level k.
/// @param X_BA      mesh frame of a in the mesh frame of b
/// @param level     k, 1..M of both
/// @param margin    [m], >= 0
/// @param[out] out  sorted by (a, b); storage is reused
/// @param[in,out] tests  increased by the tests of Fig. 3-5: all pairs of children of every pair
///                       that passed the level before
void descend(const SphereTree& a, const SphereTree& b, const Pose& X_BA, int level, double margin,
             DescentScratch& scratch, std::vector<SphereOverlap>& out, TestCounts& tests);

/// Pairs of voxels that the descent finds overlapping, level by level (Fig. 3-6).
struct DescentTrace {
  struct VoxelPair {
    std::uint32_t a = 0;
    std::uint32_t b = 0;

    friend bool operator==(const VoxelPair&, const VoxelPair&) = default;
    friend bool operator<(const VoxelPair& p, const VoxelPair& q) {
      return p.a != q.a ? p.a < q.a : p.b < q.b;
    }
  };
  /// colliding[h - 1]: at level h, sorted by (a, b). Ends with level k, or with the first level at
  /// which nothing overlaps.
  std::vector<std::vector<VoxelPair>> colliding;
  TestCounts tests{};
};

/// The descent to the letter of Fig. 3-5, in double precision, keeping every level: for figures and
/// as the oracle of descend(). Coarse radii are inflated by 1e-12 (erratum 13).
DescentTrace descend_with_trace(const voxel::Pyramid& a, const voxel::Pyramid& b, const Pose& X_BA,
                                int level, double margin);

}  // namespace gotai::collision
