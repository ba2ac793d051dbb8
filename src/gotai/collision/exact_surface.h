/// @file
/// The triangles of a shape as the measure of its contacts: exact where a distance field rounds.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "gotai/collision/curved_samples.h"
#include "gotai/collision/surface_search.h"
#include "gotai/core/types.h"
#include "gotai/voxel/shape.h"
#include "gotai/voxel/signed_triangles.h"
#include "gotai/voxel/triangle_tree.h"

namespace gotai::collision {

/// Index of the triangle nearest to a point, but for single-precision rounding of the distances;
/// kNoTriangle where none is nearer than the limit.
/// @param point  [m], frame S of the tree
/// @param limit  [m]
std::uint32_t nearest_triangle(const voxel::TriangleTree& tree, const std::array<float, 3>& point,
                               float limit, Kernel kernel = Kernel::automatic);

/// Signed distances to the surface of a shape, which must be closed and must not overlap itself.
struct ExactSurface {
  /// @param shape  with a surface model; must outlive this
  explicit ExactSurface(const voxel::Shape& shape)
      : ExactSurface(shape, voxel::SignedDistance(shape.mesh)) {}
  explicit ExactSurface(voxel::Shape&& shape) = delete;

  /// The nearest point of the surface; its distance is infinite beyond the limit.
  /// @param x       [m], mesh frame
  /// @param limit   [m]
  /// @param likely  the surface is probably nearer than this, which is looked at first [m]
  voxel::ClosestPoint nearest(const Vec3& x, double limit, double likely = 0.0) const;

  /// All that it takes of memory, itself included.
  std::size_t bytes() const {
    return sizeof(ExactSurface) + surface.bytes() + tree.bytes() + curved.bytes();
  }

  voxel::SignedTriangles surface;
  voxel::TriangleTree tree;
  CurvedSamples curved;

 private:
  ExactSurface(const voxel::Shape& shape, const voxel::SignedDistance& distance)
      : surface(shape.mesh, distance),
        tree(voxel::make_triangle_tree(distance, shape.surface.center)),
        curved(shape.surface, distance) {}
};

/// Exact distances to the surfaces of shapes, by BodyState::shape. Null where the shape's surface
/// is not closed or overlaps itself: its field is all there is.
using ExactSurfaces = std::span<const std::unique_ptr<const ExactSurface>>;

}  // namespace gotai::collision
