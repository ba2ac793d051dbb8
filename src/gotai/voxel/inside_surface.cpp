#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numeric>

#include "gotai/core/parallel.h"
#include "gotai/voxel/center_lines.h"
#include "gotai/voxel/exact_orientation.h"
#include "gotai/voxel/inside.h"
#include "gotai/voxel/triangle_rows.h"

namespace gotai::voxel {
namespace {

/// The corners of a triangle without their coordinate along an axis; the two others stay in cyclic
/// order, so that the turn's sign is that of the normal along the axis.
std::array<Vec2, 3> project(const std::array<Vec3, 3>& corners, int axis) {
  const int u = (axis + 1) % 3;
  const int v = (axis + 2) % 3;
  return {Vec2(corners[0][u], corners[0][v]), Vec2(corners[1][u], corners[1][v]),
          Vec2(corners[2][u], corners[2][v])};
}

std::array<Vec3, 3> corners_of(const geometry::Mesh& mesh, const geometry::Triangle& t) {
  return {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
}

/// Where the grid line through (u, v) along an axis meets the triangle's plane. Rounded.
double plane_crossing(const std::array<Vec3, 3>& corners, const Vec3& normal, int axis, double u,
                      double v) {
  const int iu = (axis + 1) % 3;
  const int iv = (axis + 2) % 3;
  const Vec3& a = corners[0];
  return a[axis] + (normal[iu] * (a[iu] - u) + normal[iv] * (a[iv] - v)) / normal[axis];
}

/// Winding numbers of one slab's voxel centres as differences along x.
class WindingSlab {
 public:
  WindingSlab(const CenterLines& lines, int iz)
      : lines_(lines), iz_(iz), stride_(static_cast<std::size_t>(lines.side()) + 1) {
    step_.assign(stride_ * stride_, 0);
  }

  /// Counts the crossings of the slab's rows with a triangle.
  void add(const std::array<Vec3, 3>& corners) {
    const std::array<Vec2, 3> flat = project(corners, 0);
    grid_points_in_triangle(flat, lines_.centers[1], lines_.centers[2], {iz_, iz_ + 1},
                            BorderRule::perturbed, runs_);
    if (runs_.empty()) return;
    const int exits = exact_orientation(flat[0], flat[1], flat[2]);
    const Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    for (const GridRun& run : runs_)
      for (int iy = run.first; iy <= run.last; ++iy) {
        const auto y = static_cast<std::size_t>(iy);
        const auto ix =
            static_cast<std::size_t>(first_voxel_beyond(corners, normal, exits > 0, iy));
        step_[y * stride_ + ix] -= exits;
      }
  }

  /// Calls visit(ix, iy, winding number) for every voxel that the surface winds around.
  template <typename Visit>
  void for_each_inside(const Visit& visit) const {
    for (int iy = 0; iy < lines_.side(); ++iy) {
      const std::int32_t* step = step_.data() + static_cast<std::size_t>(iy) * stride_;
      std::int32_t winding = 0;
      for (int ix = 0; ix < lines_.side(); ++ix) {
        winding += step[ix];
        if (winding != 0) visit(ix, iy, winding);
      }
    }
  }

 private:
  /// Index of the first centre behind the crossing on row iy. A centre on the triangle is inside:
  /// an entry counts before it, an exit after it.
  int first_voxel_beyond(const std::array<Vec3, 3>& corners, const Vec3& normal, bool exits,
                         int iy) const {
    const auto beyond = [&](int ix) {
      const int side =
          exact_orientation(corners[0], corners[1], corners[2], lines_.center(ix, iy, iz_));
      return exits ? side < 0 : side >= 0;
    };
    const double crossing =
        plane_crossing(corners, normal, 0, lines_.centers[1][static_cast<std::size_t>(iy)],
                       lines_.centers[2][static_cast<std::size_t>(iz_)]);
    return first_true({0, lines_.side()}, guess_index_above(lines_.centers[0], crossing), beyond);
  }

  const CenterLines& lines_;
  int iz_;
  std::size_t stride_;
  std::vector<std::int32_t> step_;  ///< winding number minus that of the voxel before, per (iy, ix)
  std::vector<GridRun> runs_;
};

/// Calls use(slab, iz) for every slab of voxels, in any order and on any thread. Sums of integers
/// do not depend on the order of the triangles.
template <typename Use>
void wind_slabs(const geometry::Mesh& mesh, const CenterLines& lines, const Use& use) {
  std::vector<std::array<Vec3, 3>> triangles;
  std::vector<IndexRange> slabs;
  triangles.reserve(mesh.triangles.size());
  slabs.reserve(mesh.triangles.size());
  for (const geometry::Triangle& t : mesh.triangles) {
    triangles.push_back(corners_of(mesh, t));
    const auto [low, high] =
        std::minmax({triangles.back()[0].z(), triangles.back()[1].z(), triangles.back()[2].z()});
    slabs.push_back(indices_within(lines.centers[2], low, high));
  }
  parallel_for(static_cast<std::size_t>(lines.side()), 4, [&](std::size_t slab) {
    const int iz = static_cast<int>(slab);
    WindingSlab winding(lines, iz);
    for (std::size_t t = 0; t < triangles.size(); ++t)
      if (slabs[t].first <= iz && iz < slabs[t].last) winding.add(triangles[t]);
    use(winding, iz);
  });
}

/// The voxels whose centre is exactly on a triangle.
void find_centers_on(const std::array<Vec3, 3>& corners, const CenterLines& lines,
                     std::vector<GridRun>& runs, std::vector<VoxelIndex>& out) {
  const Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  int axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  const auto along = static_cast<std::size_t>(axis);
  const std::size_t u = (along + 1) % 3;
  const std::size_t v = (along + 2) % 3;
  grid_points_in_triangle(project(corners, axis), lines.centers[u], lines.centers[v],
                          {0, lines.side()}, BorderRule::closed, runs);
  for (const GridRun& run : runs)
    for (int i = run.first; i <= run.last; ++i) {
      const double crossing =
          plane_crossing(corners, normal, axis, lines.centers[u][static_cast<std::size_t>(i)],
                         lines.centers[v][static_cast<std::size_t>(run.v)]);
      const std::vector<double>& centers = lines.centers[along];
      const double spacing = centers.size() > 1 ? centers[1] - centers[0] : 1.0;
      const double place = (crossing - centers[0]) / spacing;
      const double nearest = std::round(place);
      if (!(nearest >= 0.0 && nearest < lines.side() && std::abs(place - nearest) < 1e-6)) continue;
      std::array<int, 3> index{};
      index[along] = static_cast<int>(nearest);
      index[u] = i;
      index[v] = run.v;
      if (exact_orientation(corners[0], corners[1], corners[2],
                            lines.center(index[0], index[1], index[2])) == 0)
        out.push_back({static_cast<std::uint16_t>(index[0]), static_cast<std::uint16_t>(index[1]),
                       static_cast<std::uint16_t>(index[2])});
    }
}

/// Adds the voxels whose centre is exactly on the surface.
void insert_centers_on_surface(const geometry::Mesh& mesh, const CenterLines& lines,
                               VoxelSet& inside) {
  constexpr std::size_t chunk = 1024;
  const std::size_t chunks = (mesh.triangles.size() + chunk - 1) / chunk;
  std::vector<std::vector<VoxelIndex>> found(chunks);
  parallel_for(chunks, 1, [&](std::size_t c) {
    std::vector<GridRun> runs;
    const std::size_t end = std::min((c + 1) * chunk, mesh.triangles.size());
    for (std::size_t t = c * chunk; t < end; ++t)
      find_centers_on(corners_of(mesh, mesh.triangles[t]), lines, runs, found[c]);
  });
  for (const std::vector<VoxelIndex>& voxels : found)
    for (const VoxelIndex& v : voxels) inside.insert(v[0], v[1], v[2]);
}

}  // namespace

VoxelSet voxels_in_closed_surface(const geometry::Mesh& mesh, const VoxelGrid& grid, int level) {
  VoxelSet inside(level);
  const CenterLines lines(grid, level);
  // Every slab of rows is written by one thread.
  wind_slabs(mesh, lines, [&](const WindingSlab& slab, int iz) {
    slab.for_each_inside([&](int ix, int iy, std::int32_t) { inside.insert(ix, iy, iz); });
  });
  insert_centers_on_surface(mesh, lines, inside);
  return inside;
}

std::uint64_t count_overlapping_voxels(const geometry::Mesh& mesh, const VoxelGrid& grid,
                                       int level) {
  const CenterLines lines(grid, level);
  std::vector<std::uint64_t> count(static_cast<std::size_t>(lines.side()), 0);
  wind_slabs(mesh, lines, [&](const WindingSlab& slab, int iz) {
    slab.for_each_inside([&](int, int, std::int32_t winding) {
      if (std::abs(winding) > 1) ++count[static_cast<std::size_t>(iz)];
    });
  });
  return std::accumulate(count.begin(), count.end(), std::uint64_t{0});
}

bool has_closed_surface(const geometry::Mesh& mesh) {
  const auto before = [](const Vec3& a, const Vec3& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  };
  // Vertices at equal positions share the rank of the first of them.
  std::vector<std::uint32_t> order(mesh.vertices.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::uint32_t>(i);
  std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
    return before(mesh.vertices[i], mesh.vertices[j]);
  });
  std::vector<std::uint32_t> rank(order.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    rank[order[k]] = k > 0 && mesh.vertices[order[k]] == mesh.vertices[order[k - 1]]
                         ? rank[order[k - 1]]
                         : static_cast<std::uint32_t>(k);

  struct Passage {
    std::uint32_t low, high;
    std::int32_t direction;
  };
  std::vector<Passage> passages;
  passages.reserve(3 * mesh.triangles.size());
  for (const geometry::Triangle& t : mesh.triangles)
    for (std::size_t e = 0; e < 3; ++e) {
      const std::uint32_t a = rank[t[e]];
      const std::uint32_t b = rank[t[(e + 1) % 3]];
      if (a != b) passages.push_back({std::min(a, b), std::max(a, b), a < b ? 1 : -1});
    }
  std::sort(passages.begin(), passages.end(), [](const Passage& p, const Passage& q) {
    return std::pair(p.low, p.high) < std::pair(q.low, q.high);
  });
  for (std::size_t i = 0; i < passages.size();) {
    std::int32_t balance = 0;
    std::size_t j = i;
    for (; j < passages.size() && passages[j].low == passages[i].low &&
           passages[j].high == passages[i].high;
         ++j)
      balance += passages[j].direction;
    if (balance != 0) return false;
    i = j;
  }
  return !passages.empty();
}

}  // namespace gotai::voxel
