/// @file
/// Meshes as plain data. The first link of the chain: mesh -> shape -> body.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gotai/core/types.h"

namespace gotai::geometry {

using Triangle = std::array<std::uint32_t, 3>;  ///< Vertex indices, counter-clockwise from outside.
using Tetrahedron = std::array<std::uint32_t, 4>;  ///< det(v1-v0, v2-v0, v3-v0) > 0.

/// A body's boundary and, where the source has them, the tetrahedra inside.
/// Coordinates are metres in the mesh frame M, right-handed, z up (after import).
/// Vertices are shared by surface and tetrahedra; unused vertices are allowed.
struct Mesh {
  std::vector<Vec3> vertices;           ///< [m], mesh frame
  std::vector<Triangle> triangles;      ///< the surface, outward
  std::vector<Tetrahedron> tetrahedra;  ///< empty for surface meshes

  bool has_tetrahedra() const { return !tetrahedra.empty(); }
};

/// A plane shape: triangles that fill the area, in 2D (Makino 2007, section 3.2: "in 2D a triangle
/// mesh").
struct Mesh2 {
  std::vector<Vec2> vertices;       ///< [m]
  std::vector<Triangle> triangles;  ///< counter-clockwise
};

/// Smallest axis-aligned box around the vertices that triangles or tetrahedra use.
Box3 bounding_box(const Mesh& mesh);

}  // namespace gotai::geometry
