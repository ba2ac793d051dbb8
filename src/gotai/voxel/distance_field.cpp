#include "gotai/voxel/distance_field.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gotai::voxel {
namespace {

constexpr double kBandCells = 2.5;  // half width of the band that bricks cover
// Values in bricks are clamped to +-this many cells: all corners of cells in the band are nearer.
constexpr double kRangeCells = static_cast<double>(kLargestUnits) / kUnitsPerCell;
constexpr double kHalfDiagonal = 0.8660254037844387;

// Where node or brick (i, j, k) of n^3 is kept.
std::size_t offset_of(int n, int i, int j, int k) {
  const auto side = static_cast<std::size_t>(n);
  return (static_cast<std::size_t>(k) * side + static_cast<std::size_t>(j)) * side +
         static_cast<std::size_t>(i);
}

std::int16_t quantize(double value, double scale, double largest) {
  return static_cast<std::int16_t>(std::lround(std::clamp(value / scale, -largest, largest)));
}

// The values of a brick's nodes, x fastest, in units.
constexpr std::size_t kRowNodes = kBrickNodes;
using BrickValues = std::array<std::int16_t, kRowNodes * kRowNodes * kRowNodes>;

// Appends a brick.
void pack(const BrickValues& values, std::vector<std::uint8_t>& out) {
  const std::size_t first = out.size();
  out.resize(first + kBrickBytes, 0);
  for (std::size_t v = 0; v < values.size(); ++v) {
    std::uint8_t* row = out.data() + first + v / kBrickNodes * kRowBytes;
    const std::size_t i = v % kBrickNodes;
    const unsigned bits = (static_cast<unsigned>(values[v]) & 0xfffU) << (i % 2 * 4);
    row[3 * i / 2] = static_cast<std::uint8_t>(row[3 * i / 2] | (bits & 0xffU));
    row[3 * i / 2 + 1] = static_cast<std::uint8_t>(row[3 * i / 2 + 1] | bits >> 8U);
  }
}

// Value i of a row.
int unpack(const std::uint8_t* row, int i) {
  const unsigned both = row[3 * i / 2] | static_cast<unsigned>(row[3 * i / 2 + 1]) << 8U;
  const int bits = static_cast<int>(both >> (i % 2 * 4) & 0xfffU);
  return bits < 0x800 ? bits : bits - 0x1000;
}

// Distances along a row of lattice nodes after another, each query starting from the triangle that
// was nearest before.
class RowSampler {
 public:
  explicit RowSampler(const SignedDistance& surface) : surface_(surface) {}

  // Signed distance, or +-limit where the surface is farther than limit.
  double sample(const Vec3& x, double limit) {
    const ClosestPoint nearest = surface_.query(x, limit, hint_);
    if (!std::isfinite(nearest.distance)) return sign_ * limit;
    hint_ = nearest.triangle;
    sign_ = nearest.distance < 0.0 ? -1.0 : 1.0;
    return nearest.distance;
  }
  void start(double distance, std::uint32_t hint) {
    pass(distance);
    hint_ = hint;
  }
  // The next node is one whose distance is known.
  void pass(double distance) { sign_ = distance < 0.0 ? -1.0 : 1.0; }

 private:
  const SignedDistance& surface_;
  std::uint32_t hint_ = SignedDistance::kNoTriangle;
  double sign_ = 1.0;
};

// Distances at the nodes of one layer of bricks, which neighbours share.
class NodeLayer {
 public:
  explicit NodeLayer(int bricks)
      : side_(static_cast<std::size_t>(kBrickCells * bricks + 1)),
        distance_(side_ * side_ * kBrickNodes, kUnknown) {}

  // Goes on to the layer above.
  void rise() {
    const auto top = distance_.end() - static_cast<std::ptrdiff_t>(side_ * side_);
    std::copy(top, distance_.end(), distance_.begin());
    std::fill(distance_.begin() + static_cast<std::ptrdiff_t>(side_ * side_), distance_.end(),
              kUnknown);
  }
  // @param k  0 to kBrickCells
  double& at(int i, int j, int k) {
    const auto of = [](int n) { return static_cast<std::size_t>(n); };
    return distance_[(of(k) * side_ + of(j)) * side_ + of(i)];
  }
  static bool is_known(double distance) { return !std::isnan(distance); }

 private:
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  std::size_t side_;
  std::vector<double> distance_;
};

// Fills one brick. Returns whether the surface may come nearer than the band anywhere in it.
// Rows run to and fro, so that neighbours in time are neighbours in space: the sign of a node that
// is farther than the range is that of the node before, since the surface lies between no two of
// them.
// @param i0,j0  the brick's first node in the layer
bool sample_brick(const SignedDistance& surface, const Vec3& low, const DistanceField& field,
                  const ClosestPoint& center, NodeLayer& layer, int i0, int j0, BrickValues& out) {
  const double cell = field.cell;
  const double range = kRangeCells * cell;
  RowSampler sampler(surface);
  // The first node's sign is not known from a neighbour: ask without a limit.
  sampler.start(center.distance, center.triangle);
  const double first = sampler.sample(low, std::numeric_limits<double>::infinity());
  sampler.start(first, center.triangle);
  double nearest = std::numeric_limits<double>::infinity();
  for (int k = 0; k < kBrickNodes; ++k) {
    for (int row = 0; row < kBrickNodes; ++row) {
      const int j = k % 2 == 0 ? row : kBrickCells - row;
      for (int step = 0; step < kBrickNodes; ++step) {
        const int i = (k * kBrickNodes + row) % 2 == 0 ? step : kBrickCells - step;
        double& d = layer.at(i0 + i, j0 + j, k);
        if (NodeLayer::is_known(d)) {
          sampler.pass(d);
        } else {
          d = sampler.sample(low + cell * Vec3(i, j, k), range);
        }
        nearest = std::min(nearest, std::abs(d));
        out[offset_of(kBrickNodes, i, j, k)] = quantize(d, field.scale, kLargestUnits);
      }
    }
  }
  return nearest <= field.band + kHalfDiagonal * cell;
}

void sample_coarse(const SignedDistance& surface, const Vec3& low, DistanceField& field) {
  const int n = field.coarse_nodes();
  const double step = kCoarseCells * static_cast<double>(field.cell);
  field.coarse.assign(
      static_cast<std::size_t>(n) * static_cast<std::size_t>(n) * static_cast<std::size_t>(n) + 1,
      0);
  std::size_t at = 0;
  RowSampler sampler(surface);
  for (int k = 0; k < n; ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const double d =
            sampler.sample(low + step * Vec3(i, j, k), std::numeric_limits<double>::infinity());
        field.coarse[at++] = quantize(d, field.coarse_scale, 32767.0);
      }
    }
  }
}

// Largest squared slope of a brick [squared units per cell]. The gradient of a trilinear function
// is linear along each axis, so its length is convex along each axis and largest at a corner of the
// cell.
std::int64_t largest_squared_slope(const BrickValues& values) {
  constexpr int kStep[3] = {1, kBrickNodes, kBrickNodes * kBrickNodes};
  std::int64_t largest = 0;
  for (int k = 0; k < kBrickNodes; ++k) {
    for (int j = 0; j < kBrickNodes; ++j) {
      for (int i = 0; i < kBrickNodes; ++i) {
        const int index[3] = {i, j, k};
        const std::int16_t* v = values.data() + offset_of(kBrickNodes, i, j, k);
        std::int64_t squared = 0;
        for (int axis = 0; axis < 3; ++axis) {
          std::int64_t difference = 0;
          if (index[axis] < kBrickCells) difference = std::abs(v[kStep[axis]] - *v);
          if (index[axis] > 0) {
            difference = std::max<std::int64_t>(difference, std::abs(v[-kStep[axis]] - *v));
          }
          squared += difference * difference;
        }
        largest = std::max(largest, squared);
      }
    }
  }
  return largest;
}

void sample_bricks(const SignedDistance& surface, const Vec3& low, DistanceField& field) {
  const int n = field.bricks;
  const double cell = field.cell;
  const double brick_edge = kBrickCells * cell;
  const auto side = static_cast<std::size_t>(n);
  field.brick.assign(side * side * side, kNoBrickOutside);
  BrickValues values{};
  std::int32_t count = 0;
  std::int64_t steepest = 0;
  std::uint32_t hint = SignedDistance::kNoTriangle;
  NodeLayer layer(n);
  for (int k = 0; k < n; ++k) {
    if (k > 0) layer.rise();
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const Vec3 corner = low + brick_edge * Vec3(i, j, k);
        std::int32_t& brick = field.brick[offset_of(n, i, j, k)];
        const ClosestPoint center = surface.query(corner + Vec3::Constant(0.5 * brick_edge),
                                                  std::numeric_limits<double>::infinity(), hint);
        hint = center.triangle;
        if (center.distance < 0.0) brick = kNoBrickInside;
        if (std::abs(center.distance) > field.band + kHalfDiagonal * brick_edge) continue;
        if (!sample_brick(surface, corner, field, center, layer, kBrickCells * i, kBrickCells * j,
                          values))
          continue;
        brick = count++;
        steepest = std::max(steepest, largest_squared_slope(values));
        pack(values, field.values);
      }
    }
  }
  field.values.shrink_to_fit();
  field.slope = static_cast<float>(std::sqrt(static_cast<double>(steepest)) * field.scale /
                                   field.cell * (1.0 + 1e-5));
}

// Interpolates between the eight corners of a cell.
// @param corner  (i, j, k): value, in units of `scale`
template <typename Corner>
FieldValue interpolate(const Corner& corner, const Vec3& t, double scale, double cell) {
  double value = 0.0;
  Vec3 slope = Vec3::Zero();
  for (int k = 0; k < 2; ++k) {
    for (int j = 0; j < 2; ++j) {
      for (int i = 0; i < 2; ++i) {
        const double wx = i ? t.x() : 1.0 - t.x();
        const double wy = j ? t.y() : 1.0 - t.y();
        const double wz = k ? t.z() : 1.0 - t.z();
        const auto f = static_cast<double>(corner(i, j, k));
        value += wx * wy * wz * f;
        slope += f * Vec3((i ? 1 : -1) * wy * wz, wx * (j ? 1 : -1) * wz, wx * wy * (k ? 1 : -1));
      }
    }
  }
  return {value * scale, slope * (scale / cell), false};
}

}  // namespace

DistanceField make_distance_field(const SignedDistance& surface, const Vec3& center, double edge,
                                  int level) {
  DistanceField field;
  field.cell = static_cast<float>(std::ldexp(edge, 1 - level));
  field.bricks = ((1 << (level - 1)) + 2 * kFieldPadding + kBrickCells - 1) / kBrickCells;
  const double cell = field.cell;
  field.low = static_cast<float>(-0.5 * cell * field.cells());
  field.band = static_cast<float>(kBandCells * cell);
  field.trusted = static_cast<float>((kRangeCells - 2.0 * kHalfDiagonal) * cell);
  field.nearest_coarse =
      std::min(field.band, field.trusted - static_cast<float>(kHalfDiagonal * cell));
  field.scale = static_cast<float>(cell / kUnitsPerCell);
  field.coarse_scale = static_cast<float>(2.0 * cell * field.cells() / 32767.0);
  const Vec3 low = center + Vec3::Constant(field.low);
  sample_coarse(surface, low, field);
  sample_bricks(surface, low, field);
  return field;
}

FieldValue evaluate(const DistanceField& field, const Vec3& x) {
  const double cell = field.cell;
  const double size = field.cells();
  const Vec3 lattice = (x - Vec3::Constant(field.low)) / cell;
  const Vec3 inside = lattice.cwiseMax(0.0).cwiseMin(size * (1.0 - 1e-7));
  const Eigen::Vector3i c = inside.cast<int>();
  const Eigen::Vector3i b = c / kBrickCells;
  const std::int32_t brick = field.brick[offset_of(field.bricks, b.x(), b.y(), b.z())];
  FieldValue result;
  bool is_inside = brick == kNoBrickInside;
  if (brick >= 0) {
    const Eigen::Vector3i l = c - kBrickCells * b;
    const std::uint8_t* values =
        field.values.data() + static_cast<std::size_t>(brick) * kBrickBytes;
    const auto corner = [&](int i, int j, int k) {
      const int row = (l.z() + k) * kLayerBytes + (l.y() + j) * kRowBytes;
      return unpack(values + row, l.x() + i);
    };
    result = interpolate(corner, inside - c.cast<double>(), field.scale, cell);
    result.in_band = std::abs(result.distance) <= field.trusted;
    is_inside = result.distance < 0.0;
  }
  if (!result.in_band) {
    const int n = field.coarse_nodes();
    const Eigen::Vector3i l = c / kCoarseCells;
    const std::int16_t* v = field.coarse.data() + offset_of(n, l.x(), l.y(), l.z());
    const Vec3 t = inside / kCoarseCells - l.cast<double>();
    const auto corner = [&](int i, int j, int k) { return v[offset_of(n, i, j, k)]; };
    result = interpolate(corner, t, field.coarse_scale, kCoarseCells * cell);
    // The sign is known; the coarse value must not come nearer than the bricks reach.
    const double nearest = field.nearest_coarse;
    result.distance =
        is_inside ? std::min(result.distance, -nearest) : std::max(result.distance, nearest);
  }
  const Vec3 beyond = (lattice - inside) * cell;
  const double distance = beyond.norm();
  if (distance > 1e-6 * cell) {
    const double before = result.distance;
    result.distance = before + distance;
    result.gradient = (result.gradient + beyond / distance).normalized();
  }
  return result;
}

}  // namespace gotai::voxel
