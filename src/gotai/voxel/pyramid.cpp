#include "gotai/voxel/pyramid.h"

#include <cmath>
#include <numbers>

namespace gotai::voxel {

double VoxelGrid::voxel_edge(int level) const { return std::ldexp(edge, 1 - level); }

double VoxelGrid::voxel_radius(int level) const {
  return 0.5 * std::numbers::sqrt3 * voxel_edge(level);
}

Vec3 VoxelGrid::voxel_center(int level, const std::array<std::uint16_t, 3>& index) const {
  const double s = voxel_edge(level);
  return origin + s * Vec3(index[0] + 0.5, index[1] + 0.5, index[2] + 0.5);
}

}  // namespace gotai::voxel
