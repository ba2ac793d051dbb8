/// @file
/// A narrow-band signed distance field in the shape's own frame: 12-bit values on a lattice, stored
/// in bricks near the surface, with a coarse lattice of 16-bit values for everywhere else.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gotai/core/bytes_of.h"
#include "gotai/core/types.h"
#include "gotai/voxel/signed_distance.h"

namespace gotai::voxel {

inline constexpr int kBrickCells = 8;  ///< cells per side of a brick
inline constexpr int kBrickNodes = kBrickCells + 1;
/// Values of a brick are this many units of 12 bits to a cell: the most with which they reach five
/// cells. Distances of whole cells are exact.
inline constexpr int kUnitsPerCell = 409;
inline constexpr int kLargestUnits = 2047;  ///< values beyond are clamped
/// Rows of nine values along x, packed from the lowest bit on: of the 32 bits from byte 3 i / 2 of
/// a row, values i and i + 1 are the lowest 24 or, for odd i, those above the lowest four.
inline constexpr int kRowBytes = 14;
inline constexpr int kLayerBytes = kRowBytes * kBrickNodes;    ///< rows by ascending y
inline constexpr int kBrickBytes = kLayerBytes * kBrickNodes;  ///< layers by ascending z
inline constexpr std::int32_t kNoBrickOutside = -1;
inline constexpr std::int32_t kNoBrickInside = -2;
inline constexpr int kCoarseCells = 4;   ///< fine cells per coarse cell and side
inline constexpr int kFieldPadding = 4;  ///< cells between the shape's cube and the field's

/// Signed distance to a surface, negative inside, interpolated trilinearly between lattice nodes.
/// Frame S: axes of the mesh frame, origin at the centre of the shape's cube, so that single
/// precision is enough for shapes far from the mesh's origin.
struct DistanceField {
  float low = 0.0F;           ///< lowest corner of the cubic lattice, same on all axes [m], S
  float cell = 0.0F;          ///< edge of a fine cell [m]
  std::int32_t bricks = 0;    ///< bricks per side
  float scale = 0.0F;         ///< [m] per unit of `values`: cell / kUnitsPerCell
  float coarse_scale = 0.0F;  ///< [m] per unit of `coarse`
  /// Bricks hold every point nearer to the surface than this [m].
  float band = 0.0F;
  /// Values in bricks are used up to this distance; beyond it they are clamped, and the coarse
  /// lattice is used instead [m].
  float trusted = 0.0F;
  /// Largest slope of the interpolated field within bricks (about 1) [m/m].
  float slope = 1.0F;
  /// No point that uses the coarse lattice is nearer to the surface than this [m].
  float nearest_coarse = 0.0F;
  /// Brick of each 8^3 cells, x fastest; where the surface is farther than `band`: kNoBrickOutside
  /// or kNoBrickInside.
  std::vector<std::int32_t> brick;
  std::vector<std::uint8_t> values;  ///< kBrickBytes per brick
  /// Distances on every kCoarseCells-th node; (2 bricks + 1)^3, x fastest, with one value of
  /// padding.
  std::vector<std::int16_t> coarse;

  int cells() const { return bricks * kBrickCells; }
  int coarse_nodes() const { return bricks * (kBrickCells / kCoarseCells) + 1; }
  std::size_t bytes() const { return bytes_of(brick) + bytes_of(values) + bytes_of(coarse); }
};

/// Samples the distance to a surface.
/// @param center  centre of the shape's cube [m], mesh frame
/// @param edge    edge of the shape's cube [m]
/// @param level   the field has 2^(level - 1) cells along that edge; 4..kMaxLevel + 1
DistanceField make_distance_field(const SignedDistance& surface, const Vec3& center, double edge,
                                  int level);

/// Value and gradient at one point: the plain form of what collision kernels do eight at a time.
struct FieldValue {
  double distance = 0.0;         ///< [m]
  Vec3 gradient = Vec3::Zero();  ///< of the interpolated field, about unit length
  bool in_band = false;          ///< from a brick (else from the coarse lattice)
};
/// @param x  [m], frame S. Outside the lattice the distance to it is added.
FieldValue evaluate(const DistanceField& field, const Vec3& x);

}  // namespace gotai::voxel
