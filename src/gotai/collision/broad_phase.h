/// @file
/// Which bodies may touch: bounding spheres in uniform grids, one grid per size class.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "gotai/model/body_state.h"

namespace gotai::collision {

/// Two bodies that may touch. When only one of them is dynamic it is body_a; otherwise
/// body_a < body_b (as model::ContactPair).
struct BodyPair {
  model::BodyIndex body_a = 0;
  model::BodyIndex body_b = 0;

  friend bool operator==(const BodyPair&, const BodyPair&) = default;
};

/// Finds candidate pairs by their bounding spheres.
///
/// Bodies are put into size classes (largest diameter at most about twice the smallest). Each class
/// has one uniform grid whose cell is its largest diameter, so that two bodies of a class that
/// touch are in neighbouring cells; a body of a finer class looks up the grids of the coarser ones.
/// A grid wraps around: its size follows the number of bodies and not the extent of the world, so a
/// body that has flown far away costs nothing. Planes and containers are tested against every
/// dynamic body.
///
/// Keeps its storage between searches; holds no state.
class BroadPhase {
 public:
  /// Finds all pairs of which at least one body is dynamic and whose bounding volumes are not
  /// farther apart than the margin.
  /// @param radius    per body: of the sphere around the centre of mass that holds its contact
  ///                  surface [m]; unused for planes and containers
  /// @param margin    [m], >= 0
  /// @param[out] out  sorted by (body_a, body_b), each pair once; storage is reused
  void find_pairs(const model::BodyState& bodies, std::span<const double> radius, double margin,
                  std::vector<BodyPair>& out);

 private:
  struct Entry {
    double x, y, z, r;  // bounding sphere [m], W
    model::BodyIndex body;
    bool dynamic;
  };
  using Cell = std::array<std::uint32_t, 3>;

  /// The uniform grid of one size class.
  struct Grid {
    double cell = 0.0;                      // edge of a cell [m]
    Cell mask{};                            // cells per axis - 1; a power of two minus 1
    std::array<std::uint32_t, 3> stride{};  // of a cell index
    std::vector<Entry> entries;             // sorted by cell, within a cell by body
    std::vector<std::uint32_t> begin;       // per cell: its first entry; one more at the end

    Cell cell_of(double x, double y, double z) const;  // wrapped
    std::uint32_t index(const Cell& c) const {
      return c[0] * stride[0] + c[1] * stride[1] + c[2] * stride[2];
    }
  };

  void make_size_classes(const model::BodyState& bodies, std::span<const double> radius,
                         double margin);
  void fill_grid(Grid& grid);
  void pair_within(const Grid& grid, double margin);
  void pair_across(const Grid& fine, const Grid& coarse, double margin);
  void pair_unbounded(const model::BodyState& bodies, std::span<const double> radius,
                      double margin);
  static void pair_row(const Grid& grid, std::uint32_t row, double margin,
                       std::vector<BodyPair>& found);
  static void test(const Entry& a, const Entry& b, double margin, std::vector<BodyPair>& found);
  void sort_pairs(std::size_t body_count, std::vector<BodyPair>& out);

  std::vector<Grid> grids_;  // from the finest to the coarsest; the first grid_count_ are in use
  std::size_t grid_count_ = 0;
  std::vector<std::uint32_t> cell_;  // per entry, while a grid is filled
  std::vector<Entry> unsorted_;      // likewise
  // In any order: of several grids and planes, then of the rows of a grid, task by task.
  std::vector<std::vector<BodyPair>> found_{1};
  std::vector<std::uint32_t> first_;  // per body: offset of its pairs as body_a
};

}  // namespace gotai::collision
