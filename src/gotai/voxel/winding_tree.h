/// @file
/// Generalised winding numbers: how far a surface encloses a point, meaningful also for surfaces
/// with holes, overlaps and doubled faces.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gotai/core/types.h"
#include "gotai/geometry/mesh.h"

namespace gotai::voxel {

/// Bounding-volume tree over oriented triangles with the moments of the far field [Jacobson et al.
/// 2013, "Robust inside-outside segmentation using generalized winding numbers"; Barill et al.
/// 2018, "Fast winding numbers for soups and clouds"]. Triangles without area are ignored.
class WindingTree {
 public:
  /// @param mesh  its triangles; tetrahedra are not read
  explicit WindingTree(const geometry::Mesh& mesh);

  /// Solid angle of the surface seen from x, in turns: 1 inside a closed outward surface, 0 outside
  /// of it, in between near holes. Clusters farther than three times their radius are expanded to
  /// second order; the error is below 0.02.
  double winding_number(const Vec3& x) const;

  /// The same by summing over all triangles: slow, exact to rounding.
  double exact_winding_number(const Vec3& x) const;

  /// How many triangles a ray meets, but for one.
  /// @param direction  not zero
  /// @param except     index into the mesh's triangles
  int count_hits(const Vec3& from, const Vec3& direction, std::uint32_t except) const;

  /// Calls visit(low, high) for the bounding box of every triangle.
  template <typename Visit>
  void for_each_box(const Visit& visit) const {
    for (const Corners& t : triangles_)
      visit(Vec3(t.a.cwiseMin(t.b).cwiseMin(t.c)), Vec3(t.a.cwiseMax(t.b).cwiseMax(t.c)));
  }

 private:
  struct Node {
    Vec3 low, high;           // box [m]
    Vec3 center;              // area-weighted mean of the triangles [m]
    Vec3 area_vector;         // sum of area times normal [m^2]
    Mat3 moment;              // sum of (centroid - center) (area vector)^T [m^3]
    double far_squared;       // beyond this squared distance from center the moments do [m^2]
    std::uint32_t first = 0;  // leaf: first triangle; inner: right child (left is the next node)
    std::uint32_t count = 0;  // leaf: triangles; inner: 0
  };
  struct Corners {
    Vec3 a, b, c;
    std::uint32_t triangle;  // index into the mesh
  };

  std::uint32_t build(std::uint32_t begin, std::uint32_t end);

  std::vector<Corners> triangles_;  // leaf by leaf
  std::vector<Node> nodes_;
};

}  // namespace gotai::voxel
