/// @file
/// A voxel pyramid as a tree of spheres, packed for the descent.
#pragma once

#include <cstdint>
#include <vector>

#include "gotai/core/types.h"
#include "gotai/voxel/pyramid.h"

namespace gotai::collision {

/// The links and centres of a pyramid, 32 bytes per voxel. The pyramid must outlive it.
///
/// Octant of a child in its parent: bit 0 for the upper half in x, bit 1 in y, bit 2 in z.
struct SphereTree {
  struct Node {
    std::uint32_t first_child = 0;  ///< index in the next level
    std::uint32_t octants = 0;      ///< bit o is set when the child in octant o exists
  };
  const voxel::Pyramid* pyramid = nullptr;
  std::vector<std::vector<Node>> levels;  ///< levels[h - 1] belongs to level h; 1..M-1
  /// Centres of the voxels of levels 1..M [m], mesh frame.
  std::vector<std::vector<Vec3>> centers;

  const std::vector<Vec3>& centers_of(int level) const {
    return centers[static_cast<std::size_t>(level) - 1];
  }
};

/// @throws InvalidArgument when the children of a voxel are not in the order of their octants
SphereTree make_sphere_tree(const voxel::Pyramid& pyramid);

}  // namespace gotai::collision
