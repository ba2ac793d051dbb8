#include "gotai/collision/exact_surface.h"

#include <array>

namespace gotai::collision {

voxel::ClosestPoint ExactSurface::nearest(const Vec3& x, double limit, double likely) const {
  const Eigen::Vector3f p = (x - tree.center).cast<float>();
  const std::array<float, 3> point = {p.x(), p.y(), p.z()};
  std::uint32_t triangle = voxel::SignedDistance::kNoTriangle;
  if (likely > 0.0 && likely < limit)
    triangle = nearest_triangle(tree, point, static_cast<float>(likely));
  if (triangle == voxel::SignedDistance::kNoTriangle) {
    triangle = nearest_triangle(tree, point, static_cast<float>(limit));
  }
  if (triangle == voxel::SignedDistance::kNoTriangle) return {};
  return surface.nearest(x, triangle);
}

}  // namespace gotai::collision
