#include <array>
#include <utility>

#include "gotai/core/parallel.h"
#include "gotai/voxel/center_lines.h"
#include "gotai/voxel/exact_orientation.h"
#include "gotai/voxel/inside.h"

namespace gotai::voxel {
namespace {

/// An outward face of a tetrahedron.
struct Face {
  Vec3 a, b, c;
  Vec3 normal;            ///< rounded: only for guesses
  int normal_x_sign = 0;  ///< exact

  Face(const Vec3& a_, const Vec3& b_, const Vec3& c_) : a(a_), b(b_), c(c_) {
    normal = (b - a).cross(c - a);
    normal_x_sign = exact_orientation(Vec2(a.y(), a.z()), Vec2(b.y(), b.z()), Vec2(c.y(), c.z()));
  }

  /// Fig. 3-3: a . b >= 0.
  bool is_behind(const Vec3& p) const { return exact_orientation(a, b, c, p) >= 0; }
};

/// A tetrahedron with the range of voxels that its box touches.
struct Tet {
  std::array<Face, 4> faces;
  std::array<IndexRange, 3> range;
};

/// The part of a row's range behind a face. What is behind is monotone in x.
IndexRange clip(IndexRange range, const Face& face, const CenterLines& lines, int iy, int iz) {
  const auto behind = [&](int ix) { return face.is_behind(lines.center(ix, iy, iz)); };
  if (face.normal_x_sign == 0) return behind(range.first) ? range : IndexRange{};
  const Vec3 d = face.a - lines.center(0, iy, iz);
  const double crossing =
      face.a.x() + (face.normal.y() * d.y() + face.normal.z() * d.z()) / face.normal.x();
  const int guess = guess_index_above(lines.centers[0], crossing);
  if (face.normal_x_sign < 0) return {first_true(range, guess, behind), range.last};
  return {range.first, first_true(range, guess, [&](int ix) { return !behind(ix); })};
}

std::vector<Tet> tets_that_touch_centers(const geometry::Mesh& mesh, const CenterLines& lines) {
  std::vector<Tet> tets;
  for (const geometry::Tetrahedron& t : mesh.tetrahedra) {
    std::array<Vec3, 4> v{mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]],
                          mesh.vertices[t[3]]};
    Box3 box;
    for (const Vec3& corner : v) box.extend(corner);
    std::array<IndexRange, 3> range;
    for (std::size_t k = 0; k < 3; ++k)
      range[k] = indices_within(lines.centers[k], box.min()[static_cast<int>(k)],
                                box.max()[static_cast<int>(k)]);
    if (range[0].empty() || range[1].empty() || range[2].empty()) continue;
    // The fourth vertex is behind the outward face 0 2 1 of a positive tetrahedron.
    const int orientation = exact_orientation(v[0], v[2], v[1], v[3]);
    if (orientation == 0) continue;
    if (orientation < 0) std::swap(v[0], v[1]);
    tets.push_back({{Face(v[0], v[2], v[1]), Face(v[0], v[1], v[3]), Face(v[1], v[2], v[3]),
                     Face(v[2], v[0], v[3])},
                    range});
  }
  return tets;
}

}  // namespace

VoxelSet voxels_in_tetrahedra(const geometry::Mesh& mesh, const VoxelGrid& grid, int level) {
  VoxelSet inside(level);
  const CenterLines lines(grid, level);
  const std::vector<Tet> tets = tets_that_touch_centers(mesh, lines);
  // Every slab of rows is written by one thread; a union does not depend on the order.
  parallel_for(static_cast<std::size_t>(inside.side()), 4, [&](std::size_t slab) {
    const int iz = static_cast<int>(slab);
    for (const Tet& tet : tets) {
      if (iz < tet.range[2].first || iz >= tet.range[2].last) continue;
      for (int iy = tet.range[1].first; iy < tet.range[1].last; ++iy) {
        IndexRange run = tet.range[0];
        for (const Face& face : tet.faces)
          if (!run.empty()) run = clip(run, face, lines, iy, iz);
        inside.insert_run(run.first, run.last - 1, iy, iz);
      }
    }
  });
  return inside;
}

}  // namespace gotai::voxel
