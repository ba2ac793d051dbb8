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
  /// Level of the surface model, kMinSurfaceLevel..kMaxSurfaceLevel; 0: prepared without one.
  int surface_level = 0;
};

/// A prepared shape. Immutable and shared between bodies. Lengths in metres, mesh frame M.
struct Shape {
  std::string name;
  geometry::Mesh mesh;            ///< polygons for drawing, and the tetrahedra when there are any
  geometry::MassProperties mass;  ///< at density 1
  Pyramid pyramid;
  SurfaceModel surface;  ///< for the collision model `surface`; empty unless asked for
  double bounding_radius = 0.0;  ///< farthest vertex from the centre of mass [m]
  /// Farthest surface of any voxel sphere from the centre of mass, per level (index h - 1) [m]:
  /// rho of the corrected time step (erratum 29).
  std::vector<double> voxel_bounding_radius;
  Hash128 content;  ///< content_hash of mesh and options: the key of the cache
};

/// Hash of everything that a shape is made from and of the way it is made: two shapes with equal
/// hashes are equal but for their names.
Hash128 content_hash(const geometry::Mesh& mesh, const ShapeOptions& options);

/// Prepares a shape: mass properties, the voxel pyramid and, if asked for, the surface model.
/// @param mesh  its tetrahedra define the body when there are any, else its closed surface does
/// @throws InvalidArgument for a bad level, a vertex index out of range, a surface without
///   tetrahedra that is not closed, no volume, or a body so thin that no voxel's centre is inside
///   (the message names the level that would do)
Shape make_shape(std::string name, geometry::Mesh mesh, const ShapeOptions& options);

/// Sets bounding_radius and voxel_bounding_radius from mesh, mass and pyramid.
void derive_radii(Shape& shape);

}  // namespace gotai::voxel
