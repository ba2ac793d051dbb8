/// @file
/// The triangles of a surface in an 8-ary tree of boxes, laid out for searches of the nearest one
/// eight lanes at a time.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gotai/core/bytes_of.h"
#include "gotai/core/types.h"
#include "gotai/voxel/signed_distance.h"
#include "gotai/voxel/surface_model.h"

namespace gotai::voxel {

/// Eight triangles: a corner and the edges to the other two. Frame S.
struct alignas(64) TrianglePacket {
  std::array<std::array<float, kLanes>, 3> corner, edge_1, edge_2;  ///< x, y, z [m]
  std::array<std::uint32_t, kLanes> triangle;                       ///< index into the mesh's
};

/// The boxes of eight children. Frame S. Lanes without a child have low = infinity.
struct alignas(64) BoxPacket {
  std::array<std::array<float, kLanes>, 3> low, high;  ///< x, y, z [m]
};

/// Packet p of the triangles holds eight of them; lane l of packet p at height h bounds packet
/// 8p + l at height h - 1 (height 0: packets of triangles). The last height has one packet.
struct TriangleTree {
  Vec3 center = Vec3::Zero();             ///< origin of frame S [m], mesh frame
  std::vector<TrianglePacket> triangles;  ///< the last one is padded with its last triangle
  std::vector<std::vector<BoxPacket>> heights;

  std::size_t bytes() const { return bytes_of(triangles) + bytes_of(heights); }  ///< on the heap
};

/// Orders the triangles that have an area.
/// @param center  origin of frame S [m], mesh frame: near the shape, for single precision
TriangleTree make_triangle_tree(const SignedDistance& surface, const Vec3& center);

}  // namespace gotai::voxel
