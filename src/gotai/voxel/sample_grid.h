/// @file
/// Samples of a surface by the cells of a grid. Internal to sampling.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "gotai/core/types.h"

namespace gotai::voxel {

/// What a search for samples asks of one.
struct GridSample {
  Vec3 position;        ///< [m], mesh frame
  Vec3 normal;          ///< unit, outward
  double same_side;     ///< least cosine between its normal and those of points of its side
  std::uint32_t index;  ///< among all samples
};

/// Samples of a surface by cell, for searches of neighbours within one cell edge.
class SampleGrid {
 public:
  /// @param box  of all that is inserted or asked for
  SampleGrid(const Box3& box, double cell) : cell_(cell), low_(box.min()) {
    std::size_t count = 1;
    for (int axis = 0; axis < 3; ++axis) {
      // One more on either side, and one for rounding.
      size_[axis] = static_cast<int>(box.sizes()[axis] / cell) + 4;
      count *= static_cast<std::size_t>(size_[axis]);
    }
    head_.assign(count, kNone);
  }

  void insert(const GridSample& s) {
    const std::size_t slot = slot_of(cell_of(s.position));
    next_.push_back(head_[slot]);
    head_[slot] = static_cast<std::uint32_t>(samples_.size());
    samples_.push_back(s);
  }

  /// Those of a cell one after the other.
  void insert_all(std::vector<GridSample> samples) {
    std::ranges::stable_sort(samples, {},
                             [&](const GridSample& s) { return slot_of(cell_of(s.position)); });
    for (const GridSample& s : samples) insert(s);
  }

  /// Asks for what a visit to x will need.
  void prefetch(const Vec3& x) const {
    const std::uint32_t first = head_[slot_of(cell_of(x))];
    if (first != kNone) __builtin_prefetch(&samples_[first]);
  }

  /// Visits the samples of the 27 cells around x, nearer cells first.
  /// @param reach  cells that are farther than its root are left out [m^2]
  /// @param visit  (sample): the reach from then on
  template <typename Visit>
  void visit(const Vec3& x, double reach, const Visit& visit) const {
    constexpr double kRounding = 1.0 + 1e-9;
    const Eigen::Vector3i c = cell_of(x);
    const Vec3 beyond_low = x - low_ - cell_ * (c.cast<double>() - Vec3::Ones());
    for (const std::array<int, 3>& step : kAround) {
      double squared = 0.0;
      for (int axis = 0; axis < 3; ++axis) {
        const int side = step[static_cast<std::size_t>(axis)];
        const double away = side < 0 ? beyond_low[axis] : side > 0 ? cell_ - beyond_low[axis] : 0.0;
        squared += away * away;
      }
      if (squared > reach * kRounding) continue;
      for (std::uint32_t i = head_[slot_of(c + Eigen::Vector3i(step.data()))]; i != kNone;
           i = next_[i]) {
        reach = visit(samples_[i]);
      }
    }
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;
  // The middle, six faces, twelve edges, eight corners.
  static constexpr std::array<std::array<int, 3>, 27> kAround = [] {
    std::array<std::array<int, 3>, 27> steps{};
    std::size_t count = 0;
    for (int axes = 0; axes <= 3; ++axes) {
      for (int i = 0; i < 27; ++i) {
        const std::array<int, 3> step = {i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1};
        const int squared = step[0] * step[0] + step[1] * step[1] + step[2] * step[2];
        if (squared == axes) steps[count++] = step;
      }
    }
    return steps;
  }();

  Eigen::Vector3i cell_of(const Vec3& x) const {
    return ((x - low_) / cell_).cast<int>() + Eigen::Vector3i::Ones();
  }
  std::size_t slot_of(const Eigen::Vector3i& c) const {
    const auto at = [&](int axis) { return static_cast<std::size_t>(c[axis]); };
    return (at(2) * static_cast<std::size_t>(size_[1]) + at(1)) *
               static_cast<std::size_t>(size_[0]) +
           at(0);
  }

  double cell_;                                     // edge [m]
  Vec3 low_;                                        // [m]
  Eigen::Vector3i size_ = Eigen::Vector3i::Zero();  // cells per axis
  std::vector<std::uint32_t> head_;                 // by cell: its last sample
  std::vector<std::uint32_t> next_;                 // by sample: the one before in its cell
  std::vector<GridSample> samples_;
};

}  // namespace gotai::voxel
