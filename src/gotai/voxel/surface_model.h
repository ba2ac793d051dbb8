/// @file
/// What the surface collision model needs of a shape: samples in an 8-ary tree, and the distance
/// field that other shapes' samples are measured in.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "gotai/core/types.h"
#include "gotai/geometry/mesh.h"
#include "gotai/voxel/distance_field.h"
#include "gotai/voxel/surface_samples.h"
#include "gotai/voxel/winding_tree.h"

namespace gotai::voxel {

inline constexpr int kLanes = 8;  ///< children of a node: one SIMD packet

/// Eight points. Frame S.
struct alignas(32) PointPacket {
  std::array<float, kLanes> x, y, z;  ///< [m]
};

/// The bounding spheres of eight children. Frame S. Lanes without a child have radius < 0.
struct alignas(32) SpherePacket {
  std::array<float, kLanes> x, y, z;  ///< centres [m]
  std::array<float, kLanes> radius;   ///< [m]; contains every sample below the child
};

/// What a sample is besides its place: read together, for every sample that is near another shape.
/// Frame S. 16 bits tell a normal within 3e-5 rad, and areas, which only weigh, within 2e-5 of the
/// largest.
struct SurfaceElement {
  std::array<std::int16_t, 3> normal;       ///< axis of the normal cone, outward; see unit_normal()
  std::array<std::int16_t, 3> vector_area;  ///< integral of the outward normal; see vector_area()
  float cone_cosine;                        ///< cosine of the cone's half angle
};

/// One unit of SurfaceElement::normal.
inline constexpr float kNormalUnit = 1.0F / 32767.0F;
static_assert(32767.0F * kNormalUnit == 1.0F, "normals along the axes are exact");

/// Axis of a sample's normal cone, outward, unit to single precision.
inline std::array<float, 3> unit_normal(const SurfaceElement& element) {
  const float x = kNormalUnit * static_cast<float>(element.normal[0]);
  const float y = kNormalUnit * static_cast<float>(element.normal[1]);
  const float z = kNormalUnit * static_cast<float>(element.normal[2]);
  // It is off by less than 3e-5: one step of Newton's method for the inverse root is enough.
  const float scale = 1.5F - 0.5F * ((x * x + y * y) + z * z);
  return {scale * x, scale * y, scale * z};
}

/// The straight edge that a sample lies on. Frame S.
struct SampleEdge {
  std::array<float, 3> direction;  ///< unit
  float back;     ///< how far the sample may slide against the direction [m], see SurfaceSample
  float forward;  ///< and along it [m]
};

/// Where to find what only some samples of a packet have.
struct PacketLinks {
  std::uint32_t first_edge = 0;    ///< index into SurfaceTree::edges
  std::uint32_t first_vertex = 0;  ///< index into SurfaceTree::vertices
  std::uint8_t on_edge = 0;        ///< one bit per lane: samples of edges
  std::uint8_t has_vertices = 0;   ///< one bit per lane: samples with vertices near them
};

/// Samples of a surface, ordered so that an 8-ary tree needs no pointers: packet p of the points
/// holds samples 8p..8p+7, and lane l of packet p at height h bounds packet 8p + l at height h - 1
/// (height 0: packet of points). The last height has one packet.
struct SurfaceTree {
  std::vector<PointPacket> points;                 ///< the last one is padded with its last sample
  std::vector<std::vector<SpherePacket>> heights;  ///< heights[0] bounds packets of points
  std::vector<SurfaceElement> elements;            ///< per sample, in tree order
  float area_unit = 0.0F;                          ///< of SurfaceElement::vector_area [m^2]
  std::vector<SampleEdge> edges;                   ///< of samples of edges, in tree order
  /// Vertices of the mesh that samples stand for, in the order of their samples. Frame S [m].
  std::vector<std::array<float, 3>> vertices;
  std::vector<std::uint8_t> vertex_lane;  ///< of each vertex: its sample's lane in the packet
  /// Per packet of points, and what follows the last one.
  std::vector<PacketLinks> links;

  std::size_t size() const { return elements.size(); }
  std::size_t bytes() const;  ///< on the heap

  /// Integral of the outward normal over what a sample stands for [m^2]. Frame S.
  std::array<float, 3> vector_area(std::uint32_t sample) const {
    const std::array<std::int16_t, 3>& a = elements[sample].vector_area;
    return {area_unit * static_cast<float>(a[0]), area_unit * static_cast<float>(a[1]),
            area_unit * static_cast<float>(a[2])};
  }
  /// The edge that a sample lies on; null for samples of faces and corners.
  const SampleEdge* edge_of(std::uint32_t sample) const {
    const PacketLinks& packet = links[sample / kLanes];
    const unsigned bit = 1U << sample % kLanes;
    if ((packet.on_edge & bit) == 0U) return nullptr;
    return &edges[packet.first_edge +
                  static_cast<std::uint32_t>(std::popcount(packet.on_edge & (bit - 1U)))];
  }
  bool has_vertices(std::uint32_t sample) const {
    return (links[sample / kLanes].has_vertices >> sample % kLanes & 1U) != 0U;
  }
  /// The mesh's vertices near a sample [m]. Frame S.
  std::span<const std::array<float, 3>> vertices_of(std::uint32_t sample) const;
};

/// Samples and field of a shape. Frame S has the axes of the mesh frame M and its origin at
/// `center`.
struct SurfaceModel {
  int level = 0;               ///< spacing of the samples is the voxel edge of this level
  Vec3 center = Vec3::Zero();  ///< origin of frame S [m], M
  double edge = 0.0;           ///< edge of the shape's cube [m]
  double spacing = 0.0;        ///< of the samples [m]
  double area = 0.0;           ///< of the whole surface [m^2]
  SurfaceTree tree;
  DistanceField field;  ///< one level finer than the samples

  bool empty() const { return level == 0; }
  /// On the heap.
  std::size_t bytes() const { return tree.bytes() + field.bytes(); }
};

inline constexpr int kMinSurfaceLevel = 3;
inline constexpr int kMaxSurfaceLevel = 8;

/// Prepares the surface model of a mesh.
/// @param level   kMinSurfaceLevel..kMaxSurfaceLevel
/// @param accuracy  0: at that level. Else that is the coarsest level that may be taken: it rises,
///                to kMaxSurfaceLevel at most, until the thinnest walls are a voxel thick and the
///                field near the surface is off by at most this root mean square, as a fraction of
///                the largest extent
/// @param inside  the mesh's winding numbers where the surface is not closed or parts overlap;
///                null for closed surfaces
/// @throws InvalidArgument for a level out of range, a negative accuracy or a mesh without area
SurfaceModel make_surface_model(const geometry::Mesh& mesh, int level, double accuracy = 0.0,
                                const WindingTree* inside = nullptr);

/// Sets the links and lanes of a tree whose edges and vertices are there.
/// @param on_edge         per packet of points, one bit per lane: samples of edges
/// @param vertex_samples  per vertex: its sample, ascending
void link_packets(SurfaceTree& tree, const std::vector<std::uint8_t>& on_edge,
                  const std::vector<std::uint32_t>& vertex_samples);

/// Orders samples for the tree and bounds its nodes.
/// @param center  origin of frame S [m], mesh frame
SurfaceTree make_surface_tree(const std::vector<SurfaceSample>& samples, const Vec3& center);

}  // namespace gotai::voxel
