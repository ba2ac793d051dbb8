/// @file
/// A set of voxels of one level, one bit each: rows along x. At level 9 it takes 2 MiB.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace gotai::voxel {

/// Integer coordinates (ix, iy, iz) of a voxel in its level, each in [0, 2^(h-1)).
using VoxelIndex = std::array<std::uint16_t, 3>;

/// A set of voxels of level h, n = 2^(h-1) per side.
class VoxelSet {
 public:
  /// Empty. @throws InvalidArgument unless 1 <= level <= kMaxLevel
  explicit VoxelSet(int level);

  int level() const { return level_; }
  /// Voxels per side.
  int side() const { return side_; }

  bool contains(int ix, int iy, int iz) const {
    return (row(iy, iz)[static_cast<std::size_t>(ix) / 64] >> (static_cast<unsigned>(ix) % 64U) &
            1U) != 0;
  }
  void insert(int ix, int iy, int iz) { insert_run(ix, ix, iy, iz); }
  /// Adds the voxels first..last (both included) of a row; nothing when first > last.
  void insert_run(int first, int last, int iy, int iz);

  /// Adds the voxels of another set of the same level.
  void insert(const VoxelSet& other);

  std::uint64_t count() const;
  bool empty() const { return count() == 0; }

  /// Members with an empty 6-neighbour; outside the grid is empty (errata 9, 10).
  VoxelSet surface() const;

  /// Members in Morton order: x is the lowest of each three interleaved bits.
  std::vector<VoxelIndex> morton_sorted() const;

  /// The words of one row, bit ix % 64 of word ix / 64; bits beyond side() are 0.
  std::span<const std::uint64_t> row(int iy, int iz) const {
    return {words_.data() + offset(iy, iz), words_per_row_};
  }

  friend bool operator==(const VoxelSet&, const VoxelSet&) = default;

 private:
  std::size_t offset(int iy, int iz) const {
    return (static_cast<std::size_t>(iz) * static_cast<std::size_t>(side_) +
            static_cast<std::size_t>(iy)) *
           words_per_row_;
  }

  int level_;
  int side_;
  std::size_t words_per_row_;
  std::vector<std::uint64_t> words_;
};

/// The bits of the three coordinates interleaved, x lowest: neighbours in space are near each
/// other, and the children of a voxel are contiguous.
std::uint32_t morton_code(const VoxelIndex& index);
/// Inverse of morton_code.
VoxelIndex morton_index(std::uint32_t code);

}  // namespace gotai::voxel
