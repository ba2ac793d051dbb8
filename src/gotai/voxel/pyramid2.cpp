#include "gotai/voxel/pyramid2.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "gotai/core/error.h"
#include "gotai/voxel/pyramid.h"
#include "gotai/voxel/triangle_rows.h"

namespace gotai::voxel {
namespace {

/// Order along the curve that visits the children of a square one after another.
bool morton_before(const SquareIndex& a, const SquareIndex& b) {
  return morton_code({a[0], a[1], 0}) < morton_code({b[0], b[1], 0});
}

/// Squares of a Morton-sorted list with a 4-neighbour that is not in the list.
std::vector<SquareIndex> border(const std::vector<SquareIndex>& inside) {
  const auto has = [&](int ix, int iy) {
    if (ix < 0 || iy < 0) return false;
    return std::binary_search(
        inside.begin(), inside.end(),
        SquareIndex{static_cast<std::uint16_t>(ix), static_cast<std::uint16_t>(iy)}, morton_before);
  };
  std::vector<SquareIndex> result;
  for (const SquareIndex& s : inside)
    if (!has(s[0] - 1, s[1]) || !has(s[0] + 1, s[1]) || !has(s[0], s[1] - 1) ||
        !has(s[0], s[1] + 1))
      result.push_back(s);
  return result;
}

std::vector<SquareIndex> merge(const std::vector<SquareIndex>& children,
                               std::vector<std::uint32_t>& first_child) {
  std::vector<SquareIndex> parents;
  for (std::size_t i = 0; i < children.size(); ++i) {
    const SquareIndex parent{static_cast<std::uint16_t>(children[i][0] / 2),
                             static_cast<std::uint16_t>(children[i][1] / 2)};
    if (!parents.empty() && parents.back() == parent) continue;
    parents.push_back(parent);
    first_child.push_back(static_cast<std::uint32_t>(i));
  }
  first_child.push_back(static_cast<std::uint32_t>(children.size()));
  return parents;
}

void check_level(int level) {
  if (level < 1 || level > kMaxLevel)
    throw InvalidArgument("level", fmt::format("{}", level),
                          fmt::format("must be 1..{}", kMaxLevel));
}

}  // namespace

double SquareGrid::square_edge(int level) const { return std::ldexp(edge, 1 - level); }

double SquareGrid::square_radius(int level) const {
  return 0.5 * std::numbers::sqrt2 * square_edge(level);
}

Vec2 SquareGrid::square_center(int level, const SquareIndex& index) const {
  return origin + square_edge(level) * Vec2(index[0] + 0.5, index[1] + 0.5);
}

SquareGrid square_grid_around(const geometry::Mesh2& mesh) {
  Box3 box;
  for (const geometry::Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t)
      box.extend(Vec3(mesh.vertices[v].x(), mesh.vertices[v].y(), 0.0));
  const VoxelGrid cube = grid_around(box);
  return {cube.origin.head<2>(), cube.edge};
}

std::vector<SquareIndex> squares_inside(const geometry::Mesh2& mesh, const SquareGrid& grid,
                                        int level) {
  check_level(level);
  const CenterLines lines(
      VoxelGrid{Vec3(grid.origin.x(), grid.origin.y(), grid.origin.y()), grid.edge}, level);
  VoxelSet inside(level);
  std::vector<GridRun> runs;
  for (const geometry::Triangle& t : mesh.triangles) {
    grid_points_in_triangle({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]},
                            lines.centers[0], lines.centers[1], {0, lines.side()},
                            BorderRule::closed, runs);
    for (const GridRun& run : runs) inside.insert_run(run.first, run.last, run.v, 0);
  }
  std::vector<SquareIndex> squares;
  for (const VoxelIndex& v : inside.morton_sorted()) squares.push_back({v[0], v[1]});
  return squares;
}

Pyramid2 make_pyramid2(const geometry::Mesh2& mesh, int max_level) {
  check_level(max_level);
  Pyramid2 pyramid;
  pyramid.grid = square_grid_around(mesh);
  pyramid.levels.resize(static_cast<std::size_t>(max_level));
  pyramid.levels.back().index = border(squares_inside(mesh, pyramid.grid, max_level));
  if (pyramid.levels.back().size() == 0)
    throw InvalidArgument("level", fmt::format("{}", max_level),
                          "the shape is too thin: no square's centre is inside; use a finer level");
  for (std::size_t h = pyramid.levels.size() - 1; h > 0; --h)
    pyramid.levels[h - 1].index = merge(pyramid.levels[h].index, pyramid.levels[h - 1].first_child);
  for (int h = 1; h <= max_level; ++h) {
    PyramidLevel2& level = pyramid.levels[static_cast<std::size_t>(h) - 1];
    for (const SquareIndex& index : level.index)
      level.center.push_back(pyramid.grid.square_center(h, index));
  }
  return pyramid;
}

}  // namespace gotai::voxel
