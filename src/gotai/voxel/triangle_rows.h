/// @file
/// The points of a regular grid inside a plane triangle, row by row, decided exactly.
#pragma once

#include <array>
#include <vector>

#include "gotai/core/types.h"
#include "gotai/voxel/center_lines.h"

namespace gotai::voxel {

/// What a point exactly on the triangle's border is.
enum class BorderRule {
  closed,  ///< inside
  /// Decided as if every point were moved by an infinitesimal vector, the same for all triangles:
  /// of the triangles around an edge or a vertex exactly those contain the point that contain its
  /// moved copy [simulation of simplicity, Edelsbrunner and Muecke 1990].
  perturbed,
};

/// Points first..last (both included) of row v.
struct GridRun {
  int first;
  int last;
  int v;
};

/// Finds the grid points (u, v) inside a triangle. Degenerate triangles contain nothing.
/// @param corners  in either orientation
/// @param us,vs    ascending coordinates of the columns and rows
/// @param rows     the rows to look at
/// @param out      is overwritten; ascending in v
void grid_points_in_triangle(const std::array<Vec2, 3>& corners, const std::vector<double>& us,
                             const std::vector<double>& vs, IndexRange rows, BorderRule rule,
                             std::vector<GridRun>& out);

}  // namespace gotai::voxel
