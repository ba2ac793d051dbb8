/// @file
/// The shapes behind generate(), in their natural sizes. Internal to the module.
#pragma once

#include <cstdint>

#include "gotai/geometry/mesh.h"

namespace gotai::geometry::detail {

/// The i-th of n + 1 equidistant points in [-1, 1]; symmetric to the last bit.
inline double tick(int i, int n) { return static_cast<double>(2 * i - n) / n; }

/// Box of the given edges, cells^3 hexahedra of six tetrahedra.
Mesh make_box(const Vec3& extents, int cells);
/// Ball of diameter 1: a cube of cells^3 hexahedra, each point p moved to p |p|_inf / |p|_2.
Mesh make_sphere(int cells);
/// Cylinder of diameter 1 along z; a square of cells^2 mapped to the disc as in make_sphere.
Mesh make_cylinder(double height, int cells);
/// Ring around z with outer diameter 1.
/// @param ratio  radius of the tube / radius of the ring
Mesh make_torus(double ratio, int cells);
/// The wave-breaking block with six legs, extent 2.
Mesh make_hexapod();
/// Five unit cubes in the form of an L, extent 3.
Mesh make_l();
/// Star-shaped rock of mean radius about 0.5; 20 * 4^subdivisions triangles.
Mesh make_rock(int subdivisions, std::uint64_t seed, double roughness);

Mesh2 make_square(int cells);
Mesh2 make_circle(int cells);
Mesh2 make_cross();
Mesh2 make_plane_l();

}  // namespace gotai::geometry::detail
