/// @file
/// The pyramid of plane shapes: squares, four to a parent [Makino 2007, section 3.2].
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gotai/core/types.h"
#include "gotai/geometry/mesh.h"

namespace gotai::voxel {

/// Integer coordinates (ix, iy) of a square in its level, each in [0, 2^(h-1)).
using SquareIndex = std::array<std::uint16_t, 2>;

/// Square around a plane shape: the smallest around the bounding box, with the same centre.
struct SquareGrid {
  Vec2 origin = Vec2::Zero();  ///< lowest corner [m]
  double edge = 0.0;           ///< edge of the level-1 square [m]

  /// Edge s_h = s_1 / 2^(h-1) [m].
  double square_edge(int level) const;
  /// Radius of a square's circumscribed circle, sqrt(2)/2 s_h [m].
  double square_radius(int level) const;
  /// Centre of a square [m].
  Vec2 square_center(int level, const SquareIndex& index) const;
};

/// The border squares of one level, in Morton order.
struct PyramidLevel2 {
  std::vector<SquareIndex> index;
  /// size() + 1 offsets: the children of square i are [first_child[i], first_child[i+1]) of the
  /// next level. Empty at the finest level.
  std::vector<std::uint32_t> first_child;
  std::vector<Vec2> center;  ///< [m]

  std::size_t size() const { return index.size(); }
};

/// Border squares of all levels 1..M. levels[h - 1] is level h.
struct Pyramid2 {
  SquareGrid grid;
  std::vector<PyramidLevel2> levels;

  int max_level() const { return static_cast<int>(levels.size()); }
  const PyramidLevel2& level(int h) const { return levels[static_cast<std::size_t>(h) - 1]; }
};

/// The grid around a shape.
/// @throws InvalidArgument for a mesh without extent or beyond 1e+-30 m
SquareGrid square_grid_around(const geometry::Mesh2& mesh);

/// The squares whose centre is in some triangle, borders included, in Morton order. Triangles of
/// either orientation count.
/// @param level  1..kMaxLevel
std::vector<SquareIndex> squares_inside(const geometry::Mesh2& mesh, const SquareGrid& grid,
                                        int level);

/// The pyramid of a plane shape: squares_inside at the finest level, those of them with an empty
/// 4-neighbour, merged 4 to 1.
/// @param max_level  M, 1..kMaxLevel
/// @throws InvalidArgument for a bad level, or when no square's centre is inside
Pyramid2 make_pyramid2(const geometry::Mesh2& mesh, int max_level);

}  // namespace gotai::voxel
