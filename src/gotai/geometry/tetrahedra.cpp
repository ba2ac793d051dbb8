#include "gotai/geometry/tetrahedra.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace gotai::geometry {

double signed_volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return (b - a).cross(c - a).dot(d - a) / 6.0;
}

double signed_volume(const Mesh& mesh, const Tetrahedron& tet) {
  return signed_volume(mesh.vertices[tet[0]], mesh.vertices[tet[1]], mesh.vertices[tet[2]],
                       mesh.vertices[tet[3]]);
}

std::size_t orient_tetrahedra(Mesh& mesh) {
  std::size_t swapped = 0;
  for (Tetrahedron& tet : mesh.tetrahedra) {
    if (signed_volume(mesh, tet) >= 0.0) continue;
    std::swap(tet[2], tet[3]);
    ++swapped;
  }
  return swapped;
}

namespace {

/// A face of a tetrahedron under the name that all its owners share.
struct Face {
  Triangle key;         // sorted vertex indices
  std::uint32_t owner;  // tetrahedron
  std::uint32_t side;   // the vertex of the owner that is opposite
};

/// Faces of a positively oriented tetrahedron, outward; face i is opposite to vertex i.
constexpr std::array<std::array<std::uint8_t, 3>, 4> kFaces = {
    {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

}  // namespace

std::vector<Triangle> boundary_triangles(std::span<const Tetrahedron> tetrahedra) {
  std::vector<Face> faces;
  faces.reserve(tetrahedra.size() * 4);
  for (std::uint32_t t = 0; t < tetrahedra.size(); ++t)
    for (std::uint32_t side = 0; side < 4; ++side) {
      Triangle key;
      for (std::size_t k = 0; k < 3; ++k) key[k] = tetrahedra[t][kFaces[side][k]];
      std::ranges::sort(key);
      faces.push_back({key, t, side});
    }
  std::ranges::sort(faces, [](const Face& a, const Face& b) {
    return std::tie(a.key, a.owner, a.side) < std::tie(b.key, b.owner, b.side);
  });

  std::vector<std::pair<std::uint32_t, std::uint32_t>> open;
  for (std::size_t first = 0; first < faces.size();) {
    std::size_t last = first + 1;
    while (last < faces.size() && faces[last].key == faces[first].key) ++last;
    for (std::size_t i = last - first == 1 ? first : first + 2; i < last; ++i)
      open.emplace_back(faces[i].owner, faces[i].side);
    first = last;
  }
  std::ranges::sort(open);

  std::vector<Triangle> triangles;
  triangles.reserve(open.size());
  for (const auto& [owner, side] : open) {
    const Tetrahedron& tet = tetrahedra[owner];
    triangles.push_back({tet[kFaces[side][0]], tet[kFaces[side][1]], tet[kFaces[side][2]]});
  }
  return triangles;
}

void append_hexahedron(const std::array<std::uint32_t, 8>& corners,
                       std::vector<Tetrahedron>& tetrahedra) {
  // The six monotone paths from corner 0 to corner 7, every second one swapped to be positive.
  static constexpr std::array<Tetrahedron, 6> kPaths = {
      {{0, 1, 3, 7}, {0, 1, 7, 5}, {0, 2, 7, 3}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 4, 7, 6}}};
  for (const Tetrahedron& path : kPaths)
    tetrahedra.push_back({corners[path[0]], corners[path[1]], corners[path[2]], corners[path[3]]});
}

}  // namespace gotai::geometry
