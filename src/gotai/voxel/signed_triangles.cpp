#include "gotai/voxel/signed_triangles.h"

#include "gotai/voxel/triangle_point.h"

namespace gotai::voxel {

SignedTriangles::SignedTriangles(const geometry::Mesh& mesh, const SignedDistance& surface)
    : mesh_(&mesh), vertex_normal_(mesh.vertices.size(), Vec3::Zero()) {
  neighbor_.reserve(mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    neighbor_.push_back({surface.neighbor(t, 0), surface.neighbor(t, 1), surface.neighbor(t, 2)});
    // Vertices at equal positions count as one there.
    for (std::size_t k = 0; k < 3; ++k) {
      vertex_normal_[mesh.triangles[t][k]] = surface.vertex_normal(surface.corners(t)[k]);
    }
  }
}

Vec3 SignedTriangles::face_normal(std::uint32_t triangle) const {
  return triangle_normal(corner(triangle, 0), corner(triangle, 1), corner(triangle, 2));
}

Vec3 SignedTriangles::pseudonormal(std::uint32_t triangle, int feature) const {
  if (feature < 3) {
    return vertex_normal_[mesh_->triangles[triangle][static_cast<std::size_t>(feature)]]
        .normalized();
  }
  const std::uint32_t other = feature < 6
                                  ? neighbor_[triangle][static_cast<std::size_t>(feature) - 3]
                                  : SignedDistance::kNoTriangle;
  if (other == SignedDistance::kNoTriangle) return face_normal(triangle);
  return edge_pseudonormal(face_normal(triangle), face_normal(other));
}

ClosestPoint SignedTriangles::nearest(const Vec3& x, std::uint32_t triangle) const {
  const TrianglePoint at =
      closest_on_triangle(x, corner(triangle, 0), corner(triangle, 1), corner(triangle, 2));
  ClosestPoint result;
  result.point = at.point;
  result.triangle = triangle;
  result.pseudonormal = pseudonormal(triangle, at.feature);
  const Vec3 away = x - at.point;
  result.distance = away.norm();
  if (away.dot(result.pseudonormal) < 0.0) result.distance = -result.distance;
  return result;
}

}  // namespace gotai::voxel
