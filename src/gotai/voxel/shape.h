/// @file
/// Everything that is prepared once per shape: the second link of the chain mesh -> shape -> body.
#pragma once

#include <string>

#include "gotai/core/hash.h"
#include "gotai/geometry/mass_properties.h"
#include "gotai/geometry/mesh.h"
#include "gotai/voxel/pyramid.h"
#include "gotai/voxel/surface_model.h"

namespace gotai::voxel {

/// What a shape is prepared with.
struct ShapeOptions {
  int prepared_level = 7;  ///< M, the finest level of the pyramid, 1..kMaxLevel
  /// Level of the surface model, kMinSurfaceLevel..kMaxSurfaceLevel, for worlds at the same level;
  /// 0: none, for the thesis's spheres alone.
  int surface_level = 6;
  /// A wish: the surface level rises from there until the thinnest walls are a voxel thick and the
  /// surface is off by at most this, as a fraction of the largest extent; 0: the level is as given.
  double accuracy = 0.0;
  /// Thickness that makes a solid of an open sheet (or a hollow shell of a closed surface) [m];
  /// 0: the surface encloses the body.
  double thickness = 0.0;
};

/// A prepared shape. Immutable and shared between bodies. Lengths in metres, mesh frame M.
struct Shape {
  std::string name;
  /// Polygons for drawing, and the tetrahedra when there are any. Re-oriented when the surface was
  /// not closed; the walls of the sheet when a thickness was asked for.
  geometry::Mesh mesh;
  geometry::MassProperties mass;  ///< at density 1
  /// Bound of the relative error of mass.volume: 0 where it is integrated exactly, half of the
  /// surface voxels where it is counted in voxels.
  double volume_error = 0.0;
  std::vector<std::string> warnings;  ///< what was assumed about the surface, one sentence each
  Pyramid pyramid;
  SurfaceModel surface;          ///< for the collision model `surface`; empty unless asked for
  double bounding_radius = 0.0;  ///< farthest vertex from the centre of mass [m]
  /// Farthest surface of any voxel sphere from the centre of mass, per level (index h - 1) [m]:
  /// rho of the corrected time step (erratum 29).
  std::vector<double> voxel_bounding_radius;
  Hash128 content;  ///< content_hash of mesh and options: the key of the cache

  /// All that it takes of memory, itself included, but for texts.
  std::size_t bytes() const;
};

/// Hash of everything that a shape is made from and of the way it is made: two shapes with equal
/// hashes are equal but for their names.
Hash128 content_hash(const geometry::Mesh& mesh, const ShapeOptions& options);

/// Prepares a shape: mass properties, the voxel pyramid and, if asked for, the surface model.
///
/// The body is what the tetrahedra fill, else what the surface encloses. A surface with holes,
/// flipped triangles or doubled faces is re-oriented (see orient_soup) and encloses the points with
/// a generalised winding number above 1/2; its mass, and that of closed surfaces whose parts
/// overlap, is counted in voxels. All of that is said in warnings.
/// @param mesh  with consistent indices
/// @throws InvalidArgument for a bad level or thickness, a vertex index out of range, a sheet or a
///   surface too open to enclose a body (unless a thickness is given), no volume, or a body so thin
///   that no voxel's centre is inside (the message names the level that would do)
Shape make_shape(std::string name, geometry::Mesh mesh, const ShapeOptions& options);

/// Sets bounding_radius and voxel_bounding_radius from mesh, mass and pyramid.
void derive_radii(Shape& shape);

}  // namespace gotai::voxel
