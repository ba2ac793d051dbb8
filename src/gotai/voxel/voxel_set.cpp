#include "gotai/voxel/voxel_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cassert>

#include "gotai/core/error.h"
#include "gotai/voxel/pyramid.h"

namespace gotai::voxel {
namespace {

/// Moves bit i to bit 3 i, for i < 10.
std::uint32_t spread_bits(std::uint32_t v) {
  v = (v | (v << 16U)) & 0x030000FFU;
  v = (v | (v << 8U)) & 0x0300F00FU;
  v = (v | (v << 4U)) & 0x030C30C3U;
  v = (v | (v << 2U)) & 0x09249249U;
  return v;
}

/// Inverse of spread_bits; ignores the other bits.
std::uint32_t gather_bits(std::uint32_t v) {
  v &= 0x09249249U;
  v = (v | (v >> 2U)) & 0x030C30C3U;
  v = (v | (v >> 4U)) & 0x0300F00FU;
  v = (v | (v >> 8U)) & 0x030000FFU;
  v = (v | (v >> 16U)) & 0x000003FFU;
  return v;
}

/// Calls visit(ix) for every bit of a row, ascending.
template <typename Visit>
void for_each_bit(std::span<const std::uint64_t> row, const Visit& visit) {
  for (std::size_t w = 0; w < row.size(); ++w)
    for (std::uint64_t bits = row[w]; bits != 0; bits &= bits - 1)
      visit(static_cast<int>(64 * w) + std::countr_zero(bits));
}

}  // namespace

std::uint32_t morton_code(const VoxelIndex& index) {
  return spread_bits(index[0]) | (spread_bits(index[1]) << 1U) | (spread_bits(index[2]) << 2U);
}

VoxelIndex morton_index(std::uint32_t code) {
  return {static_cast<std::uint16_t>(gather_bits(code)),
          static_cast<std::uint16_t>(gather_bits(code >> 1U)),
          static_cast<std::uint16_t>(gather_bits(code >> 2U))};
}

VoxelSet::VoxelSet(int level) : level_(level) {
  if (level < 1 || level > kMaxLevel)
    throw InvalidArgument("level", fmt::format("{}", level),
                          fmt::format("must be 1..{}", kMaxLevel));
  side_ = 1 << (level - 1);
  words_per_row_ = (static_cast<std::size_t>(side_) + 63) / 64;
  const auto rows = static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_);
  words_.assign(rows * words_per_row_, 0);
}

void VoxelSet::insert_run(int first, int last, int iy, int iz) {
  if (first > last) return;
  assert(first >= 0 && last < side_);
  std::uint64_t* words = words_.data() + offset(iy, iz);
  for (int w = first / 64; w <= last / 64; ++w) {
    const int low = std::max(first - 64 * w, 0);
    const int high = std::min(last - 64 * w, 63);
    words[w] |= (~std::uint64_t{0} >> static_cast<unsigned>(63 - high + low))
                << static_cast<unsigned>(low);
  }
}

void VoxelSet::insert(const VoxelSet& other) {
  assert(other.level_ == level_);
  for (std::size_t w = 0; w < words_.size(); ++w) words_[w] |= other.words_[w];
}

std::uint64_t VoxelSet::count() const {
  std::uint64_t sum = 0;
  for (const std::uint64_t word : words_) sum += static_cast<std::uint64_t>(std::popcount(word));
  return sum;
}

VoxelSet VoxelSet::surface() const {
  VoxelSet result(level_);
  for (int iz = 0; iz < side_; ++iz) {
    for (int iy = 0; iy < side_; ++iy) {
      const auto here = row(iy, iz);
      const bool has_four_rows = iy > 0 && iy + 1 < side_ && iz > 0 && iz + 1 < side_;
      std::uint64_t* out = result.words_.data() + offset(iy, iz);
      for (std::size_t w = 0; w < words_per_row_; ++w) {
        std::uint64_t full = 0;
        if (has_four_rows) {
          const std::uint64_t below = (here[w] << 1U) | (w > 0 ? here[w - 1] >> 63U : 0);
          const std::uint64_t above =
              (here[w] >> 1U) | (w + 1 < words_per_row_ ? here[w + 1] << 63U : 0);
          full = below & above & row(iy - 1, iz)[w] & row(iy + 1, iz)[w] & row(iy, iz - 1)[w] &
                 row(iy, iz + 1)[w];
        }
        out[w] = here[w] & ~full;
      }
    }
  }
  return result;
}

std::vector<VoxelIndex> VoxelSet::morton_sorted() const {
  std::vector<std::uint32_t> codes;
  codes.reserve(count());
  for (int iz = 0; iz < side_; ++iz)
    for (int iy = 0; iy < side_; ++iy)
      for_each_bit(row(iy, iz), [&](int ix) {
        codes.push_back(morton_code({static_cast<std::uint16_t>(ix), static_cast<std::uint16_t>(iy),
                                     static_cast<std::uint16_t>(iz)}));
      });
  std::sort(codes.begin(), codes.end());
  std::vector<VoxelIndex> sorted(codes.size());
  std::transform(codes.begin(), codes.end(), sorted.begin(), morton_index);
  return sorted;
}

}  // namespace gotai::voxel
