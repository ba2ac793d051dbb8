#include "gotai/voxel/triangle_rows.h"

#include "gotai/voxel/exact_orientation.h"

namespace gotai::voxel {
namespace {

/// Whether p is on the inner (left) side of the edge a -> b of a counter-clockwise triangle.
bool is_inner(const Vec2& a, const Vec2& b, const Vec2& p, BorderRule rule) {
  const int side = exact_orientation(a, b, p);
  if (side != 0) return side > 0;
  if (rule == BorderRule::closed) return true;
  // p moves by (e, e^2), e > 0 infinitesimal: (b - a) x (e, e^2) decides.
  if (a.y() != b.y()) return b.y() < a.y();
  return b.x() > a.x();
}

/// The part of range whose points (us[i], v) are on the inner side of an edge.
IndexRange clip(IndexRange range, const Vec2& a, const Vec2& b, const std::vector<double>& us,
                double v, BorderRule rule) {
  const auto inner = [&](int i) {
    return is_inner(a, b, {us[static_cast<std::size_t>(i)], v}, rule);
  };
  if (a.y() == b.y()) return inner(range.first) ? range : IndexRange{};
  const double crossing = a.x() + (b.x() - a.x()) * ((v - a.y()) / (b.y() - a.y()));
  const int guess = guess_index_above(us, crossing);
  if (b.y() < a.y()) return {first_true(range, guess, inner), range.last};
  return {range.first, first_true(range, guess, [&](int i) { return !inner(i); })};
}

}  // namespace

void grid_points_in_triangle(const std::array<Vec2, 3>& corners, const std::vector<double>& us,
                             const std::vector<double>& vs, IndexRange rows, BorderRule rule,
                             std::vector<GridRun>& out) {
  out.clear();
  const Vec2 low = corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]);
  const Vec2 high = corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]);
  const IndexRange columns = indices_within(us, low.x(), high.x());
  if (columns.empty()) return;
  IndexRange touched = indices_within(vs, low.y(), high.y());
  touched = {std::max(touched.first, rows.first), std::min(touched.last, rows.last)};
  if (touched.empty()) return;

  const int turn = exact_orientation(corners[0], corners[1], corners[2]);
  if (turn == 0) return;
  const Vec2& a = corners[0];
  const Vec2& b = turn > 0 ? corners[1] : corners[2];
  const Vec2& c = turn > 0 ? corners[2] : corners[1];
  for (int row = touched.first; row < touched.last; ++row) {
    const double v = vs[static_cast<std::size_t>(row)];
    IndexRange run = columns;
    if (!run.empty()) run = clip(run, a, b, us, v, rule);
    if (!run.empty()) run = clip(run, b, c, us, v, rule);
    if (!run.empty()) run = clip(run, c, a, us, v, rule);
    if (!run.empty()) out.push_back({run.first, run.last - 1, row});
  }
}

}  // namespace gotai::voxel
