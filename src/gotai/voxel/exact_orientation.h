/// @file
/// Signs of orientation determinants, exact for all doubles whose products neither overflow nor
/// underflow. A voxel's centre on a shared face must be judged alike from both sides (erratum 7).
#pragma once

#include "gotai/core/types.h"

namespace gotai::voxel {

/// Sign of (b - a) x (p - a): +1 when p is left of the line a -> b, 0 when it is exactly on it.
/// Method: floating-point filter, then expansions [Shewchuk 1997, "Adaptive Precision
/// Floating-Point Arithmetic and Fast Robust Geometric Predicates"].
int exact_orientation(const Vec2& a, const Vec2& b, const Vec2& p);

/// Sign of (b - a) x (c - a) . (a - p): +1 when p is behind the triangle, on the side opposite to
/// its normal, 0 when it is exactly on its plane.
int exact_orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p);

}  // namespace gotai::voxel
