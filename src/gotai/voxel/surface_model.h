/// @file
/// What the surface collision model needs of a shape: samples in an 8-ary tree, and the distance
/// field that other shapes' samples are measured in.
#pragma once

#include <array>
#include <cstdint>
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

/// Samples of a surface, ordered so that an 8-ary tree needs no pointers: packet p of the points
/// holds samples 8p..8p+7, and lane l of packet p at height h bounds packet 8p + l at height h - 1
/// (height 0: packet of points). The last height has one packet.
struct SurfaceTree {
  std::vector<PointPacket> points;                 ///< the last one is padded with its last sample
  std::vector<std::vector<SpherePacket>> heights;  ///< heights[0] bounds packets of points
  // Per sample, in tree order. Frame S.
  std::vector<std::array<float, 3>> normal;       ///< axis of the normal cone, unit, outward
  std::vector<float> cone_cosine;                 ///< cosine of the cone's half angle
  std::vector<std::array<float, 3>> vector_area;  ///< integral of the outward normal [m^2]
  std::vector<SampleKind> kind;                   ///< face, edge or corner
  std::vector<std::array<float, 3>>
      edge_direction;                            ///< unit; of samples [0, edge_count)... see edge
  std::vector<std::array<float, 2>> edge_reach;  ///< back, forward [m]; likewise
  std::vector<std::int32_t> edge;                ///< index into edge_*; -1 for other kinds
  /// Vertices of the mesh near sample i: [first_vertex[i], first_vertex[i + 1]). Frame S [m].
  std::vector<std::array<float, 3>> vertex;
  std::vector<std::uint32_t> first_vertex;

  std::size_t size() const { return normal.size(); }
  std::size_t bytes() const;
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

/// Orders samples for the tree and bounds its nodes.
/// @param center  origin of frame S [m], mesh frame
SurfaceTree make_surface_tree(const std::vector<SurfaceSample>& samples, const Vec3& center);

}  // namespace gotai::voxel
