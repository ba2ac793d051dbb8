#include "gotai/render/surface_normals.h"

#include <cmath>

namespace gotai::render {

std::vector<Eigen::Vector3f> corner_normals(const geometry::Mesh& mesh) {
  const double crease = std::cos(32.0 * 3.14159265358979 / 180.0);
  std::vector<Vec3> face;  // area-weighted
  std::vector<std::vector<std::size_t>> around(mesh.vertices.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    face.emplace_back(
        (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]));
    for (const std::uint32_t vertex : {a, b, c}) around[vertex].push_back(t);
  }
  std::vector<Eigen::Vector3f> normals;
  normals.reserve(3 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t vertex : mesh.triangles[t]) {
      Vec3 sum = Vec3::Zero();
      for (const std::size_t other : around[vertex])
        if (face[other].dot(face[t]) >= crease * face[other].norm() * face[t].norm())
          sum += face[other];
      normals.push_back((sum.norm() > 0.0 ? sum.normalized() : Vec3::UnitZ()).cast<float>());
    }
  return normals;
}

}  // namespace gotai::render
