/// @file
/// Shapes made from numbers: the bodies of the experiments and of scenes without mesh files.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "gotai/core/types.h"
#include "gotai/geometry/mesh.h"

namespace gotai::geometry {

/// What to make. A default of 0 stands for the shape's own.
struct GeneratorOptions {
  /// One of generator_names() (for generate) or plane_generator_names() (for generate_plane).
  std::string shape = "cube";
  /// Largest extent of the bounding box [m]; 0 keeps the shape's natural size.
  double size = 0.0;
  /// Edges of "box" along x, y, z [m]; scaled to `size` when that is given.
  Vec3 extents = Vec3::Ones();
  /// Fineness, 0 = the shape's own. cube, box: cells per edge (1). sphere: cells per edge of the
  /// cube that is mapped to the ball, 6 n^3 tetrahedra (6, so 1,296). torus, cylinder, disc,
  /// circle: cells across the round section (4, 6, 6, 8). rock: halvings of the icosahedron's
  /// edges, 20 * 4^n triangles (3). The others have one form.
  int subdivisions = 0;
  /// Makes a rock what it is; the same rock at every fineness.
  std::uint64_t seed = 1;
  /// Amplitude of a rock's noise as a fraction of its radius, in [0, 0.9).
  double roughness = 0.25;
  /// torus: radius of the tube / radius of the ring, in (0, 1). cylinder, disc: height / diameter.
  /// 0 = the shape's own: 0.3, 1, 0.1.
  double thickness = 0.0;
};

/// "box", "cube", "cylinder", "disc", "hexapod", "l", "rock", "sphere", "torus".
const std::vector<std::string>& generator_names();
/// "circle", "cross", "l", "square".
const std::vector<std::string>& plane_generator_names();

/// Tetrahedra and their oriented, closed surface.
///
/// Natural sizes and frames [m]: cube, box, sphere, cylinder, disc (axis z) and torus (axis z) are
/// centred on the origin with largest extent 1 (box: its extents); hexapod: core cube of half width
/// 0.28, six legs that taper from 0.28 to 0.18, tips at 1, extent 2, 42 tetrahedra; l: five unit
/// cubes along x and z, extent 3, box centred on the origin; rock: star-shaped about the origin,
/// radius 0.5 (1 + roughness * noise), noise smooth and in [-1, 1].
/// @throws InvalidArgument for an unknown shape (with the allowed names) or an impossible value
Mesh generate(const GeneratorOptions& options);

/// Plane shapes for the figures in 2D: square (edge 1), circle (diameter 1), cross (the hexapod's
/// section, extent 2), l (five unit squares, extent 3); centred as in generate().
/// @throws InvalidArgument as generate()
Mesh2 generate_plane(const GeneratorOptions& options);

}  // namespace gotai::geometry
