#include "gotai/voxel/pyramid.h"

#include <fmt/format.h>

#include <cassert>
#include <cmath>
#include <numbers>

#include "gotai/core/bytes_of.h"
#include "gotai/core/error.h"

namespace gotai::voxel {
namespace {

/// The level above: one parent per run of voxels that share it. Writes the runs' starts to
/// first_child.
std::vector<VoxelIndex> merge(const std::vector<VoxelIndex>& children,
                              std::vector<std::uint32_t>& first_child) {
  std::vector<VoxelIndex> parents;
  for (std::size_t i = 0; i < children.size(); ++i) {
    const VoxelIndex parent{static_cast<std::uint16_t>(children[i][0] / 2),
                            static_cast<std::uint16_t>(children[i][1] / 2),
                            static_cast<std::uint16_t>(children[i][2] / 2)};
    if (!parents.empty() && parents.back() == parent) continue;
    parents.push_back(parent);
    first_child.push_back(static_cast<std::uint32_t>(i));
  }
  first_child.push_back(static_cast<std::uint32_t>(children.size()));
  parents.shrink_to_fit();
  first_child.shrink_to_fit();
  return parents;
}

}  // namespace

double VoxelGrid::voxel_edge(int level) const { return std::ldexp(edge, 1 - level); }

double VoxelGrid::voxel_radius(int level) const {
  return 0.5 * std::numbers::sqrt3 * voxel_edge(level);
}

Vec3 VoxelGrid::voxel_center(int level, const VoxelIndex& index) const {
  const double s = voxel_edge(level);
  return origin + s * Vec3(index[0] + 0.5, index[1] + 0.5, index[2] + 0.5);
}

std::size_t Pyramid::bytes() const {
  std::size_t total = bytes_of(levels);
  for (const PyramidLevel& level : levels)
    total += bytes_of(level.index) + bytes_of(level.first_child);
  return total;
}

std::vector<Vec3> Pyramid::voxel_centers(int h) const {
  std::vector<Vec3> centers;
  centers.reserve(level(h).size());
  for (const VoxelIndex& index : level(h).index) centers.push_back(grid.voxel_center(h, index));
  return centers;
}

VoxelGrid grid_around(const Box3& box) {
  if (box.isEmpty()) throw InvalidArgument("mesh", "empty", "has no triangles or tetrahedra");
  const Vec3 center = 0.5 * (box.min() + box.max());
  const double edge = box.sizes().maxCoeff();
  // The negated comparisons also catch NaN.
  if (!(edge >= 1e-30 && edge <= 1e30))
    throw InvalidArgument("mesh", fmt::format("{}", edge),
                          "its largest extent must be between 1e-30 and 1e30 m; check the unit");
  if (!(center.cwiseAbs().maxCoeff() <= 1e10 * edge))
    throw InvalidArgument("mesh", fmt::format("{}", center.cwiseAbs().maxCoeff()),
                          "is too far from its origin for its size; move it there");
  return {center - Vec3::Constant(0.5 * edge), edge};
}

Pyramid build_pyramid(const VoxelGrid& grid, const VoxelSet& inside) {
  std::vector<VoxelIndex> surface = inside.surface().morton_sorted();
  if (surface.empty())
    throw InvalidArgument("inside", "empty", "has no voxel; prepare a finer level");
  return pyramid_from_surface(grid, inside.level(), std::move(surface));
}

Pyramid pyramid_from_surface(const VoxelGrid& grid, int max_level,
                             std::vector<VoxelIndex> surface) {
  assert(!surface.empty());
  Pyramid pyramid;
  pyramid.grid = grid;
  pyramid.levels.resize(static_cast<std::size_t>(max_level));
  pyramid.levels.back().index = std::move(surface);
  for (std::size_t h = pyramid.levels.size() - 1; h > 0; --h)
    pyramid.levels[h - 1].index = merge(pyramid.levels[h].index, pyramid.levels[h - 1].first_child);
  return pyramid;
}

}  // namespace gotai::voxel
