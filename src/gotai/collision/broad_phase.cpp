#include "gotai/collision/broad_phase.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "gotai/core/parallel.h"

namespace gotai::collision {

namespace {

// Octaves of body sizes that get a counter of their own; sizes beyond share the outermost ones.
constexpr int kOctaves = 128;

// Rows of cells that are paired by one task. More tasks than threads, so that they end together.
constexpr std::size_t kRowChunks = 16;

/// Smallest and largest diameter of the bodies of one octave of sizes.
struct SizeRange {
  double min = std::numeric_limits<double>::infinity();
  double max = 0.0;

  bool empty() const { return max == 0.0; }
};

std::size_t octave(double diameter) {
  return static_cast<std::size_t>(std::clamp(std::ilogb(diameter) + kOctaves / 2, 0, kOctaves - 1));
}

/// Consecutive cells along x, wrapped: one or two runs of [first, last].
struct Runs {
  std::array<std::array<std::uint32_t, 2>, 2> run;
  std::size_t count;
};

Runs consecutive_cells(std::uint32_t first, std::uint32_t count, std::uint32_t mask) {
  const std::uint32_t last = first + count - 1;
  if (last <= mask) return {{{{first, last}}}, 1};
  return {{{{first, mask}, {0, last - mask - 1}}}, 2};
}

/// Can a sphere reach a face of an open box? Conservative: the walls are taken as endless.
bool reaches_container(const Vec3& center, double reach, const Vec3& half_extent) {
  if (center.z() <= reach) return true;
  if (center.z() - reach > half_extent.z()) return false;
  return half_extent.x() - std::abs(center.x()) <= reach ||
         half_extent.y() - std::abs(center.y()) <= reach;
}

}  // namespace

BroadPhase::Cell BroadPhase::Grid::cell_of(double x, double y, double z) const {
  // Far beyond any world; keeps the conversion to an integer defined.
  static constexpr double kLimit = 1e15;
  const auto wrap = [this](double coordinate, std::uint32_t axis_mask) {
    const double i = std::clamp(std::floor(coordinate / cell), -kLimit, kLimit);
    return static_cast<std::uint32_t>(static_cast<std::int64_t>(i) & axis_mask);
  };
  return {wrap(x, mask[0]), wrap(y, mask[1]), wrap(z, mask[2])};
}

void BroadPhase::find_pairs(const model::BodyState& bodies, std::span<const double> radius,
                            double margin, std::vector<BodyPair>& out) {
  for (std::vector<BodyPair>& found : found_) found.clear();
  make_size_classes(bodies, radius, margin);
  for (std::size_t g = 0; g < grid_count_; ++g) {
    fill_grid(grids_[g]);
    pair_within(grids_[g], margin);
  }
  for (std::size_t fine = 0; fine < grid_count_; ++fine) {
    for (std::size_t coarse = fine + 1; coarse < grid_count_; ++coarse) {
      pair_across(grids_[fine], grids_[coarse], margin);
    }
  }
  pair_unbounded(bodies, radius, margin);
  sort_pairs(bodies.size(), out);
}

void BroadPhase::make_size_classes(const model::BodyState& bodies, std::span<const double> radius,
                                   double margin) {
  std::array<SizeRange, kOctaves> sizes{};
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies.geometry[i] != model::Geometry::shape) continue;
    const double diameter = 2.0 * radius[i] + margin;
    SizeRange& range = sizes[octave(diameter)];
    range.min = std::min(range.min, diameter);
    range.max = std::max(range.max, diameter);
  }

  // From fine to coarse: an octave joins the class before it when the sizes stay within a factor
  // of two, so that nearly equal bodies on both sides of a power of two share one grid.
  std::array<std::size_t, kOctaves> class_of{};
  grid_count_ = 0;
  double class_min = 0.0;
  for (std::size_t o = 0; o < sizes.size(); ++o) {
    if (sizes[o].empty()) continue;
    if (grid_count_ == 0 || sizes[o].max > 2.0 * class_min) {
      if (grids_.size() == grid_count_) grids_.emplace_back();
      grids_[grid_count_].entries.clear();
      grids_[grid_count_].cell = 0.0;
      ++grid_count_;
      class_min = sizes[o].min;
    }
    class_of[o] = grid_count_ - 1;
    Grid& grid = grids_[grid_count_ - 1];
    // The allowance keeps bodies that touch in neighbouring cells under rounding.
    grid.cell = std::max(grid.cell, 1.000001 * sizes[o].max);
  }

  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies.geometry[i] != model::Geometry::shape) continue;
    const auto body = static_cast<model::BodyIndex>(i);
    const Vec3& x = bodies.x_W[i];
    grids_[class_of[octave(2.0 * radius[i] + margin)]].entries.push_back(
        {x.x(), x.y(), x.z(), radius[i], body, bodies.is_dynamic(body)});
  }
}

void BroadPhase::fill_grid(Grid& grid) {
  std::array<double, 3> low;
  std::array<double, 3> high;
  low.fill(std::numeric_limits<double>::infinity());
  high.fill(-std::numeric_limits<double>::infinity());
  for (const Entry& e : grid.entries) {
    const std::array<double, 3> x{e.x, e.y, e.z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], x[axis]);
      high[axis] = std::max(high[axis], x[axis]);
    }
  }

  // Cells as the extent asks for, at most about four per body; at least four along an axis, so
  // that the three neighbours of a wrapped cell are different ones.
  const std::uint64_t limit = std::max<std::uint64_t>(64, 4 * std::bit_ceil(grid.entries.size()));
  std::array<std::uint64_t, 3> count{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double cells = std::clamp((high[axis] - low[axis]) / grid.cell + 2.0, 4.0, 1048576.0);
    count[axis] = std::bit_ceil(static_cast<std::uint64_t>(cells));
  }
  while (count[0] * count[1] * count[2] > limit) *std::max_element(count.begin(), count.end()) /= 2;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    grid.mask[axis] = static_cast<std::uint32_t>(count[axis] - 1);
  }
  grid.stride = {1, static_cast<std::uint32_t>(count[0]),
                 static_cast<std::uint32_t>(count[0] * count[1])};

  // Counting sort by cell.
  const std::size_t cells = count[0] * count[1] * count[2];
  grid.begin.assign(cells + 1, 0);
  cell_.resize(grid.entries.size());
  for (std::size_t i = 0; i < grid.entries.size(); ++i) {
    cell_[i] = grid.index(grid.cell_of(grid.entries[i].x, grid.entries[i].y, grid.entries[i].z));
    ++grid.begin[cell_[i]];
  }
  std::uint32_t sum = 0;
  for (std::uint32_t& b : grid.begin) b = (sum += b);
  std::swap(unsorted_, grid.entries);
  grid.entries.resize(unsorted_.size());
  for (std::size_t i = unsorted_.size(); i-- > 0;) {
    grid.entries[--grid.begin[cell_[i]]] = unsorted_[i];
  }
}

void BroadPhase::test(const Entry& a, const Entry& b, double margin, std::vector<BodyPair>& found) {
  const double dx = a.x - b.x;
  const double dy = a.y - b.y;
  const double dz = a.z - b.z;
  const double reach = a.r + b.r + margin;
  // The allowance keeps spheres that touch exactly.
  if (dx * dx + dy * dy + dz * dz > reach * reach * (1.0 + 1e-12)) return;
  if (!a.dynamic && !b.dynamic) return;
  const bool a_first = a.dynamic == b.dynamic ? a.body < b.body : a.dynamic;
  found.push_back(a_first ? BodyPair{a.body, b.body} : BodyPair{b.body, a.body});
}

void BroadPhase::pair_within(const Grid& grid, double margin) {
  const std::size_t rows = (grid.mask[1] + std::size_t{1}) * (grid.mask[2] + std::size_t{1});
  const std::size_t size = (rows + kRowChunks - 1) / kRowChunks;
  const std::size_t chunks = (rows + size - 1) / size;
  if (found_.size() < chunks + 1) found_.resize(chunks + 1);
  // Less work than this is done before another thread has woken up.
  constexpr std::size_t kFewEntries = 256;
  const std::size_t grain = grid.entries.size() < kFewEntries ? chunks : 1;
  parallel_for(chunks, grain, [&](std::size_t c) {
    for (std::size_t row = c * size; row < std::min(rows, (c + 1) * size); ++row) {
      pair_row(grid, static_cast<std::uint32_t>(row), margin, found_[c + 1]);
    }
  });
}

void BroadPhase::pair_row(const Grid& grid, std::uint32_t row, double margin,
                          std::vector<BodyPair>& found) {
  const auto against = [&](std::uint32_t begin, std::uint32_t end, std::uint32_t first_cell,
                           std::uint32_t last_cell) {
    const std::uint32_t other_begin = grid.begin[first_cell];
    const std::uint32_t other_end = grid.begin[last_cell + 1];
    for (std::uint32_t i = begin; i < end; ++i) {
      for (std::uint32_t j = other_begin; j < other_end; ++j) {
        test(grid.entries[i], grid.entries[j], margin, found);
      }
    }
  };
  // Half of the 26 neighbours: every pair of cells is visited once.
  constexpr std::array<std::array<std::uint32_t, 2>, 4> kRows{
      {{1, 0}, {~0U, 1}, {0, 1}, {1, 1}}};  // (dy, dz); ~0 wraps to -1
  const std::uint32_t y = row % (grid.mask[1] + 1);
  const std::uint32_t z = row / (grid.mask[1] + 1);
  for (std::uint32_t x = 0; x <= grid.mask[0]; ++x) {
    const std::uint32_t cell = grid.index({x, y, z});
    const std::uint32_t begin = grid.begin[cell];
    const std::uint32_t end = grid.begin[cell + 1];
    if (begin == end) continue;
    for (std::uint32_t i = begin; i < end; ++i) {
      for (std::uint32_t j = i + 1; j < end; ++j) {
        test(grid.entries[i], grid.entries[j], margin, found);
      }
    }
    const std::uint32_t next = grid.index({(x + 1) & grid.mask[0], y, z});
    against(begin, end, next, next);
    const Runs runs = consecutive_cells((x - 1) & grid.mask[0], 3, grid.mask[0]);
    for (const auto& [dy, dz] : kRows) {
      const std::uint32_t other = grid.index({0, (y + dy) & grid.mask[1], (z + dz) & grid.mask[2]});
      for (std::size_t r = 0; r < runs.count; ++r) {
        against(begin, end, other + runs.run[r][0], other + runs.run[r][1]);
      }
    }
  }
}

void BroadPhase::pair_across(const Grid& fine, const Grid& coarse, double margin) {
  for (const Entry& e : fine.entries) {
    // Centres of the coarse bodies that e can touch; at most three cells along an axis.
    const double reach = 0.5 * coarse.cell + e.r + 0.5 * margin;
    const Cell low = coarse.cell_of(e.x - reach, e.y - reach, e.z - reach);
    const Cell high = coarse.cell_of(e.x + reach, e.y + reach, e.z + reach);
    const Cell count{((high[0] - low[0]) & coarse.mask[0]) + 1,
                     ((high[1] - low[1]) & coarse.mask[1]) + 1,
                     ((high[2] - low[2]) & coarse.mask[2]) + 1};
    const Runs runs = consecutive_cells(low[0], count[0], coarse.mask[0]);
    for (std::uint32_t dz = 0; dz < count[2]; ++dz) {
      for (std::uint32_t dy = 0; dy < count[1]; ++dy) {
        const std::uint32_t row =
            coarse.index({0, (low[1] + dy) & coarse.mask[1], (low[2] + dz) & coarse.mask[2]});
        for (std::size_t r = 0; r < runs.count; ++r) {
          const std::uint32_t end = coarse.begin[row + runs.run[r][1] + 1];
          for (std::uint32_t j = coarse.begin[row + runs.run[r][0]]; j < end; ++j) {
            test(e, coarse.entries[j], margin, found_[0]);
          }
        }
      }
    }
  }
}

void BroadPhase::pair_unbounded(const model::BodyState& bodies, std::span<const double> radius,
                                double margin) {
  for (std::size_t u = 0; u < bodies.size(); ++u) {
    if (bodies.geometry[u] == model::Geometry::shape) continue;
    const Vec3& x_U = bodies.x_W[u];
    const Mat3 R_UW = bodies.q_WB[u].toRotationMatrix().transpose();
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const auto body = static_cast<model::BodyIndex>(i);
      if (bodies.geometry[i] != model::Geometry::shape || !bodies.is_dynamic(body)) continue;
      const double reach = radius[i] * (1.0 + 1e-12) + margin;
      const Vec3 center = R_UW * (bodies.x_W[i] - x_U);
      const bool touches = bodies.geometry[u] == model::Geometry::plane
                               ? center.z() <= reach
                               : reaches_container(center, reach, bodies.half_extent[u]);
      if (touches) found_[0].push_back({body, static_cast<model::BodyIndex>(u)});
    }
  }
}

void BroadPhase::sort_pairs(std::size_t body_count, std::vector<BodyPair>& out) {
  // Counting sort by body_a; the few pairs of one body are then sorted by body_b.
  first_.assign(body_count + 1, 0);
  for (const std::vector<BodyPair>& found : found_) {
    for (const BodyPair& p : found) ++first_[p.body_a];
  }
  std::uint32_t sum = 0;
  for (std::uint32_t& f : first_) f = (sum += f);
  out.resize(sum);
  for (const std::vector<BodyPair>& found : found_) {
    for (const BodyPair& p : found) out[--first_[p.body_a]] = p;
  }
  constexpr std::size_t kBodiesPerTask = 128;
  parallel_for(body_count, kBodiesPerTask, [&](std::size_t a) {
    std::sort(out.begin() + first_[a], out.begin() + first_[a + 1],
              [](const BodyPair& p, const BodyPair& q) { return p.body_b < q.body_b; });
  });
}

}  // namespace gotai::collision
