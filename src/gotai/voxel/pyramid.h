/// @file
/// The pyramid of surface voxels [Makino 2007, section 3.2, Figs. 3-1..3-4].
///
/// Level 1 is one cube around the whole shape; level h has 2^(h-1) voxels per side. The finest
/// prepared level M is tested, reduced to its surface, and merged 8 to 1 into the coarser levels.
#pragma once

#include <cstdint>
#include <vector>

#include "gotai/core/types.h"
#include "gotai/voxel/voxel_set.h"

namespace gotai::voxel {

inline constexpr int kMaxLevel = 9;  ///< 256 voxels per side.

/// Cube around a shape, in its mesh frame: the smallest around the bounding box, with the same
/// centre (erratum 11).
struct VoxelGrid {
  Vec3 origin = Vec3::Zero();  ///< lowest corner [m], mesh frame
  double edge = 0.0;           ///< edge of the level-1 voxel [m]

  /// Voxel edge s_h = s_1 / 2^(h-1) [m].
  double voxel_edge(int level) const;
  /// Radius of a voxel's circumscribed sphere, sqrt(3)/2 s_h [m].
  double voxel_radius(int level) const;
  /// Centre of voxel (ix, iy, iz) of a level [m], mesh frame.
  Vec3 voxel_center(int level, const VoxelIndex& index) const;
  friend bool operator==(const VoxelGrid&, const VoxelGrid&) = default;
};

/// The smallest cube around a box, with the same centre.
/// @throws InvalidArgument when the box is empty, not finite, has no extent, or is so large or
/// small
///   (beyond 1e+-30 m) or so far from the origin that voxels cannot be told apart in doubles
VoxelGrid grid_around(const Box3& box);

/// The surface voxels of one level, in Morton order, so that the children of a voxel are
/// contiguous.
struct PyramidLevel {
  std::vector<VoxelIndex> index;  ///< (ix, iy, iz) per voxel
  /// size() + 1 offsets: the children of voxel i are [first_child[i], first_child[i+1]) of the next
  /// level. Empty at the finest level.
  std::vector<std::uint32_t> first_child;

  std::size_t size() const { return index.size(); }
};

/// Surface voxels of all levels 1..M. levels[h - 1] is level h.
struct Pyramid {
  VoxelGrid grid;
  std::vector<PyramidLevel> levels;

  int max_level() const { return static_cast<int>(levels.size()); }
  const PyramidLevel& level(int h) const { return levels[static_cast<std::size_t>(h) - 1]; }
  std::size_t bytes() const;  ///< on the heap
  /// Centre of voxel i of level h [m], mesh frame.
  Vec3 voxel_center(int h, std::size_t i) const { return grid.voxel_center(h, level(h).index[i]); }
  /// Of all voxels of level h.
  std::vector<Vec3> voxel_centers(int h) const;
};

/// Takes the surface of the inside voxels at the finest level and merges it 8 to 1 up to level 1
/// (errata 8-10).
/// @param inside  the voxels whose centre is in the body; its level becomes max_level()
/// @throws InvalidArgument when there is none
Pyramid build_pyramid(const VoxelGrid& grid, const VoxelSet& inside);

/// The same from the finest level's surface voxels.
/// @param surface  level max_level, strictly ascending in Morton order, not empty
Pyramid pyramid_from_surface(const VoxelGrid& grid, int max_level, std::vector<VoxelIndex> surface);

}  // namespace gotai::voxel
