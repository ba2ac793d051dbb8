/// @file
/// Signs of determinants without rounding error. Internal to the module.
#pragma once

#include "gotai/core/types.h"

namespace gotai::geometry::detail {

/// Sign of det(b - a, c - a, d - a): on which side of the plane a, b, c the point d lies; +1, 0,
/// -1. Exact as long as products of three coordinates neither overflow nor underflow.
int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Sign of the area of the triangle a, b, c: +1 counter-clockwise, 0 collinear, -1. Exact as above.
int orientation(const Vec2& a, const Vec2& b, const Vec2& c);

}  // namespace gotai::geometry::detail
