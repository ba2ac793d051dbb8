#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "gotai/geometry/edges.h"
#include "gotai/voxel/inside_soup.h"
#include "gotai/voxel/orient_soup.h"

namespace gotai::voxel {
namespace {

using geometry::Mesh;
using geometry::Triangle;

constexpr double kLongestMitre = 2.0;

/// Where two triangles go on into each other, and where a sheet ends.
struct Seams {
  geometry::detail::DisjointSets corners;      ///< corner 3 t + k; joined ones move alike
  std::vector<std::array<bool, 3>> is_border;  ///< per side k -> k + 1 of every triangle

  explicit Seams(std::size_t triangles)
      : corners(3 * triangles), is_border(triangles, {true, true, true}) {}
};

/// Index of the corner of a triangle at a vertex.
std::uint32_t corner_at(const Mesh& mesh, std::uint32_t triangle, std::uint32_t vertex) {
  const Triangle& t = mesh.triangles[triangle];
  const auto k = static_cast<std::uint32_t>(std::find(t.begin(), t.end(), vertex) - t.begin());
  return 3 * triangle + k;
}

/// The side of a triangle along an edge.
std::size_t side_along(const Mesh& mesh, const geometry::detail::HalfEdge& edge) {
  return corner_at(mesh, edge.triangle, edge.forward ? edge.low : edge.high) % 3;
}

Seams find_seams(const Mesh& mesh) {
  Seams seams(mesh.triangles.size());
  const auto sides = geometry::detail::sorted_half_edges(mesh.triangles);
  geometry::detail::for_each_edge(sides, [&](std::span<const geometry::detail::HalfEdge> edge) {
    if (edge.size() != 2 || edge[0].forward == edge[1].forward) return;
    for (const std::uint32_t v : {edge[0].low, edge[0].high})
      seams.corners.unite(corner_at(mesh, edge[0].triangle, v),
                          corner_at(mesh, edge[1].triangle, v));
    for (const auto& half : edge) seams.is_border[half.triangle][side_along(mesh, half)] = false;
  });
  return seams;
}

/// How far each corner moves for a thickness of 2: the direction that leaves all faces around it,
/// as long as needed to move them by 1.
std::vector<Vec3> mitres(const Mesh& mesh, Seams& seams) {
  const std::size_t corners = 3 * mesh.triangles.size();
  std::vector<Vec3> face_normal;
  std::vector<Vec3> sum(corners, Vec3::Zero());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& v = mesh.triangles[t];
    std::array<Vec3, 3> p{mesh.vertices[v[0]], mesh.vertices[v[1]], mesh.vertices[v[2]]};
    face_normal.push_back((p[1] - p[0]).cross(p[2] - p[0]).normalized());
    for (std::uint32_t k = 0; k < 3; ++k) {
      const Vec3 u = p[(k + 1) % 3] - p[k];
      const Vec3 w = p[(k + 2) % 3] - p[k];
      const double angle = std::atan2(u.cross(w).norm(), u.dot(w));
      sum[seams.corners.find(3 * t + k)] += angle * face_normal.back();
    }
  }
  // The face that the common direction leaves least decides its length.
  std::vector<double> least(corners, 1.0);
  for (Vec3& s : sum) s = s.norm() > 0.0 ? Vec3(s.normalized()) : s;
  for (std::uint32_t c = 0; c < corners; ++c) {
    const std::uint32_t group = seams.corners.find(c);
    least[group] = std::min(least[group], sum[group].dot(face_normal[c / 3]));
  }
  for (std::size_t c = 0; c < corners; ++c) sum[c] /= std::max(least[c], 1.0 / kLongestMitre);
  return sum;
}

}  // namespace

Mesh thicken(const Mesh& mesh, double thickness) {
  const Mesh sheet = orient_soup(mesh).mesh;
  Seams seams = find_seams(sheet);
  const std::vector<Vec3> mitre = mitres(sheet, seams);

  Mesh solid;
  // Vertex 2 g moves to the front and 2 g + 1 to the back, g counting the groups of corners.
  constexpr std::uint32_t none = 0xffffffff;
  std::vector<std::uint32_t> front_of_group(mitre.size(), none);
  const auto front = [&](std::uint32_t corner) {
    const std::uint32_t group = seams.corners.find(corner);
    if (front_of_group[group] == none) {
      front_of_group[group] = static_cast<std::uint32_t>(solid.vertices.size());
      const Vec3& p = sheet.vertices[sheet.triangles[corner / 3][corner % 3]];
      solid.vertices.push_back(p + 0.5 * thickness * mitre[group]);
      solid.vertices.push_back(p - 0.5 * thickness * mitre[group]);
    }
    return front_of_group[group];
  };
  for (std::uint32_t t = 0; t < sheet.triangles.size(); ++t) {
    const std::array<std::uint32_t, 3> v{front(3 * t), front(3 * t + 1), front(3 * t + 2)};
    solid.triangles.push_back(v);
    solid.triangles.push_back({v[0] + 1, v[2] + 1, v[1] + 1});
    for (std::size_t k = 0; k < 3; ++k) {
      if (!seams.is_border[t][k]) continue;
      const std::uint32_t a = v[k];
      const std::uint32_t b = v[(k + 1) % 3];
      solid.triangles.push_back({b, a, a + 1});
      solid.triangles.push_back({b, a + 1, b + 1});
    }
  }
  return solid;
}

}  // namespace gotai::voxel
