/// @file
/// Building blocks for tetrahedral meshes: volumes, orientation, boundary, subdivided hexahedra.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gotai/geometry/mesh.h"

namespace gotai::geometry {

/// Signed volume of the tetrahedron a, b, c, d: det(b - a, c - a, d - a) / 6 [m^3].
double signed_volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
/// The same for an entry of mesh.tetrahedra.
double signed_volume(const Mesh& mesh, const Tetrahedron& tet);

/// Swaps two vertices of every tetrahedron with a negative volume, so that all are positive or
/// flat.
/// @returns how many were swapped
std::size_t orient_tetrahedra(Mesh& mesh);

/// The faces that exactly one tetrahedron has, counter-clockwise from outside, in the order of the
/// tetrahedra. Expects positively oriented tetrahedra. Faces shared by two tetrahedra are inside;
/// a face shared by more than two is kept once for each tetrahedron beyond a pair.
std::vector<Triangle> boundary_triangles(std::span<const Tetrahedron> tetrahedra);

/// Six tetrahedra around the diagonal 0-7 of a hexahedron (Kuhn's subdivision). Neighbours in a
/// lattice that number their corners alike meet face to face.
/// @param corners  bit 0 of the index goes along x, bit 1 along y, bit 2 along z
void append_hexahedron(const std::array<std::uint32_t, 8>& corners,
                       std::vector<Tetrahedron>& tetrahedra);

}  // namespace gotai::geometry
