/// @file
/// In-out tests: the voxels whose centre is in a body.
#pragma once

#include <cstdint>

#include "gotai/geometry/mesh.h"
#include "gotai/voxel/pyramid.h"
#include "gotai/voxel/voxel_set.h"

namespace gotai::voxel {

/// The voxels whose centre is in some tetrahedron, borders included [Makino 2007, Fig. 3-3]: for
/// all four faces a . b >= 0, with a from the centre to the face and b its outward normal.
/// Departs from the thesis: a ends at a vertex of the face instead of its centroid, the sign is
/// exact, tetrahedra of either orientation count, flat ones do not (errata 6, 7).
/// The result does not depend on the number of threads.
/// @param mesh   with tetrahedra; its triangles are not read
/// @param level  1..kMaxLevel
VoxelSet voxels_in_tetrahedra(const geometry::Mesh& mesh, const VoxelGrid& grid, int level);

/// The voxels whose centre is in a closed surface or exactly on it: where the surface winds around
/// the centre, counted exactly along grid lines. Parts may overlap; cavities are empty when their
/// surface is oriented towards them. Equals voxels_in_tetrahedra for the surface of a tetrahedral
/// mesh. The result does not depend on the number of threads.
/// @param mesh   with a surface for which has_closed_surface(mesh); its tetrahedra are not read
/// @param level  1..kMaxLevel
VoxelSet voxels_in_closed_surface(const geometry::Mesh& mesh, const VoxelGrid& grid, int level);

/// How many of voxels_in_closed_surface the surface encloses more than once: where parts overlap.
std::uint64_t count_overlapping_voxels(const geometry::Mesh& mesh, const VoxelGrid& grid,
                                       int level);

/// Whether every edge is passed equally often in both directions (vertices at equal positions are
/// one): then every point has a whole winding number. False without triangles.
bool has_closed_surface(const geometry::Mesh& mesh);

}  // namespace gotai::voxel
