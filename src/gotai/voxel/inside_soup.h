/// @file
/// The inside of surfaces that are not closed: how much they enclose, their voxels, the mass of
/// those, and sheets made solid.
#pragma once

#include "gotai/geometry/mass_properties.h"
#include "gotai/geometry/mesh.h"
#include "gotai/voxel/pyramid.h"
#include "gotai/voxel/voxel_set.h"
#include "gotai/voxel/winding_tree.h"

namespace gotai::voxel {

/// How far a surface encloses a solid, 0..1. On a closed surface the winding numbers just in front
/// and just behind add up to an odd number (1, or 3 inside another part); this is 1 minus the mean
/// departure from it: 0 for a flat sheet, 0.6 for half a sphere, less than 1 by the solid angle
/// that is lost in holes.
/// @param mesh  oriented as orient_soup() does; the mesh of the tree
double enclosure(const geometry::Mesh& mesh, const WindingTree& tree);

/// Least area of the lids that would close a surface, as a share of its area: the length of the sum
/// of its area vectors. 0 for closed surfaces, 1 for a flat sheet, 0.5 for half a sphere.
double missing_share(const geometry::Mesh& mesh);

/// The voxels around whose centre the surface winds more than half a turn.
VoxelSet voxels_by_winding(const WindingTree& tree, const VoxelGrid& grid, int level);

/// Mass properties of a set of voxels at density 1, each a solid cube.
/// @param voxels  not empty
geometry::MassProperties voxel_mass(const VoxelSet& voxels, const VoxelGrid& grid);

/// Bound of the relative error of a volume that was counted in voxels: half of the surface voxels.
double voxel_volume_error(const VoxelSet& voxels);

/// Makes a solid of a surface: every piece is moved out and in by half of the thickness along its
/// normals (mitred at creases, at most twice the way), and its borders are walled. The result is
/// closed (has_closed_surface); a closed surface becomes a hollow shell.
/// @param thickness  [m], > 0
geometry::Mesh thicken(const geometry::Mesh& mesh, double thickness);

}  // namespace gotai::voxel
