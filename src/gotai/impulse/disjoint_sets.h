/// @file
/// Which of many things are connected.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace gotai::impulse {

/// Sets of the numbers 0..n-1 that can be joined; the least member stands for a set (union-find).
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) { reset(n); }

  /// Makes it n sets of one number each; storage is kept.
  void reset(std::size_t n) {
    parent_.resize(n);
    std::iota(parent_.begin(), parent_.end(), 0U);
  }

  /// Least member of i's set. Halves the path on the way.
  std::uint32_t least(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  void join(std::uint32_t i, std::uint32_t j) {
    i = least(i);
    j = least(j);
    parent_[std::max(i, j)] = std::min(i, j);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace gotai::impulse
