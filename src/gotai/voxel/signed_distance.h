/// @file
/// Exact signed distance to a closed triangle surface, in double precision: the measure that shapes
/// are prepared with and judged by.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "gotai/core/types.h"
#include "gotai/geometry/mesh.h"
#include "gotai/voxel/winding_tree.h"

namespace gotai::voxel {

/// The point of a surface that is nearest to a query point.
struct ClosestPoint {
  double distance = std::numeric_limits<double>::infinity();  ///< [m], < 0 inside
  Vec3 point = Vec3::Zero();                                  ///< on the surface [m], mesh frame
  Vec3 pseudonormal = Vec3::Zero();  ///< unit, outward, of the face, edge or vertex at `point`
  std::uint32_t triangle = 0;        ///< index into the mesh's triangles
};

/// Bounding-volume tree over the triangles of a mesh with nearest-point queries. The sign comes
/// from angle-weighted pseudonormals [Baerentzen and Aanaes 2005, "Signed distance computation
/// using the angle weighted pseudonormal"], which is exact for closed, outward, non-intersecting
/// surfaces. Vertices at equal positions count as one. Triangles without area are ignored.
class SignedDistance {
 public:
  /// @param inside  decides the sign (more than half a turn is inside) for surfaces that are not
  ///                closed or whose parts overlap; must outlive this. Null: pseudonormals do.
  /// @throws InvalidArgument when no triangle has an area
  explicit SignedDistance(const geometry::Mesh& mesh, const WindingTree* inside = nullptr);

  /// @param x            query point [m], mesh frame
  /// @param limit  surfaces farther than this are not found: the distance is infinite then [m]
  /// @param hint   a triangle that is probably near: makes the query faster, changes nothing else
  ///               but which of several equally near points is found
  ClosestPoint query(const Vec3& x, double limit = std::numeric_limits<double>::infinity(),
                     std::uint32_t hint = kNoTriangle) const;

  /// Unit outward normal of a triangle; zero for one without area.
  const Vec3& face_normal(std::uint32_t triangle) const { return face_normal_[triangle]; }
  /// The triangle across edge e (from corner e to corner e + 1), or kNoTriangle at a boundary or
  /// non-manifold edge.
  std::uint32_t neighbor(std::uint32_t triangle, int edge) const {
    return neighbor_[triangle][static_cast<std::size_t>(edge)];
  }
  /// Vertex indices of a triangle after equal positions were merged.
  const geometry::Triangle& corners(std::uint32_t triangle) const { return triangles_[triangle]; }
  const Vec3& vertex(std::uint32_t index) const { return vertices_[index]; }
  /// Sum of the normals of the faces around a vertex, weighted by their angles.
  const Vec3& vertex_normal(std::uint32_t index) const { return vertex_normal_[index]; }
  std::size_t triangle_count() const { return triangles_.size(); }
  std::size_t vertex_count() const { return vertices_.size(); }

  static constexpr std::uint32_t kNoTriangle = 0xffffffff;

 private:
  // Two children, whose boxes are looked at together.
  struct Node {
    std::array<Eigen::Array2d, 3> low, high;  // x, y, z of the boxes [m]
    std::array<std::uint32_t, 2> first{};     // leaf: first of order_; inner: node
    std::array<std::uint32_t, 2> count{};     // leaf: triangles; inner: 0
  };

  void merge_vertices(const geometry::Mesh& mesh);
  void find_normals();
  void find_neighbors();
  void build();
  void build_node(std::vector<Vec3>& centers, std::uint32_t begin, std::uint32_t end);
  void build_child(std::vector<Vec3>& centers, std::uint32_t begin, std::uint32_t end,
                   std::uint32_t node, std::size_t child);
  Vec3 pseudonormal(std::uint32_t triangle, int feature) const;
  bool is_inside(const Vec3& x, const ClosestPoint& nearest) const;

  const WindingTree* inside_;
  std::vector<Vec3> vertices_;
  std::vector<geometry::Triangle> triangles_;
  std::vector<Vec3> face_normal_;
  std::vector<Vec3> vertex_normal_;  // angle-weighted, not normalised
  std::vector<std::array<std::uint32_t, 3>> neighbor_;
  std::vector<std::uint32_t> order_;          // triangles with area, leaf by leaf
  std::vector<std::array<Vec3, 3>> corners_;  // of the triangles in that order
  std::vector<Node> nodes_;
};

}  // namespace gotai::voxel
