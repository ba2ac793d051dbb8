/// @file
/// The coordinates of voxel centres along each axis, and searches among them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "gotai/core/types.h"
#include "gotai/voxel/pyramid.h"

namespace gotai::voxel {

/// Half-open range of indices; empty when first >= last.
struct IndexRange {
  int first = 0;
  int last = 0;

  bool empty() const { return first >= last; }
};

/// Centre coordinates of the voxels of one level. centers[axis][i] equals
/// VoxelGrid::voxel_center(level, ..)[axis] to the bit.
struct CenterLines {
  std::array<std::vector<double>, 3> centers;  ///< ascending [m], mesh frame

  CenterLines(const VoxelGrid& grid, int level) {
    const int side = 1 << (level - 1);
    const double s = grid.voxel_edge(level);
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (int i = 0; i < side; ++i)
        centers[axis].push_back(grid.origin[static_cast<int>(axis)] + s * (i + 0.5));
  }

  int side() const { return static_cast<int>(centers[0].size()); }
  Vec3 center(int ix, int iy, int iz) const {
    return {centers[0][static_cast<std::size_t>(ix)], centers[1][static_cast<std::size_t>(iy)],
            centers[2][static_cast<std::size_t>(iz)]};
  }
};

/// Indices of the coordinates in the closed interval [low, high].
inline IndexRange indices_within(const std::vector<double>& coordinates, double low, double high) {
  const auto begin = coordinates.begin();
  return {static_cast<int>(std::lower_bound(begin, coordinates.end(), low) - begin),
          static_cast<int>(std::upper_bound(begin, coordinates.end(), high) - begin)};
}

/// Index of the coordinate (evenly spaced, ascending) just above a position; outside the range it
/// may be any number out of range. Rounded: only a guess.
inline int guess_index_above(const std::vector<double>& coordinates, double position) {
  const double spacing = coordinates.size() > 1 ? coordinates[1] - coordinates[0] : 1.0;
  const double index = std::ceil((position - coordinates[0]) / spacing);
  return static_cast<int>(std::clamp(index, -1.0, static_cast<double>(coordinates.size())));
}

/// Smallest index in range for which the predicate is true; range.last when there is none.
/// @param predicate  false up to some index and true from there on
/// @param guess      tried first: the search then takes two evaluations instead of log2(n)
template <typename Predicate>
int first_true(IndexRange range, int guess, const Predicate& predicate) {
  int low = range.first;
  int high = range.last;
  if (guess > low && guess < high) {
    if (predicate(guess)) {
      high = guess;
      if (!predicate(guess - 1)) return guess;
      high = guess - 1;
    } else {
      low = guess + 1;
    }
  }
  while (low < high) {
    const int middle = low + (high - low) / 2;
    if (predicate(middle)) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  return low;
}

}  // namespace gotai::voxel
