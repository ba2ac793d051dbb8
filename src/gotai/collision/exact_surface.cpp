#include "gotai/collision/exact_surface.h"

namespace gotai::collision {

ExactSurface::ExactSurface(const voxel::Shape& shape)
    : surface(shape.mesh),
      tree(voxel::make_triangle_tree(surface, shape.surface.center)),
      curved(shape.surface, surface) {}

voxel::ClosestPoint ExactSurface::nearest(const Vec3& x, double limit) const {
  const Eigen::Vector3f p = (x - tree.center).cast<float>();
  const std::uint32_t triangle =
      nearest_triangle(tree, {p.x(), p.y(), p.z()}, static_cast<float>(limit));
  if (triangle == voxel::SignedDistance::kNoTriangle) return {};
  return surface.query_triangle(x, triangle);
}

}  // namespace gotai::collision
