/// @file
/// The point of a triangle that is nearest to another point.
#pragma once

#include "gotai/core/types.h"

namespace gotai::voxel {

/// A point of a triangle and the feature it lies on.
struct TrianglePoint {
  Vec3 point;   ///< [m]
  int feature;  ///< corner 0..2, edge 3..5 (edge e from corner e), face 6
};

/// The point of triangle a, b, c that is nearest to p [Ericson 2005, "Real-Time Collision
/// Detection", section 5.1.5].
inline TrianglePoint closest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b,
                                         const Vec3& c) {
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const Vec3 ap = p - a;
  const double d1 = ab.dot(ap);
  const double d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return {a, 0};
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp);
  const double d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return {b, 1};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return {a + ab * (d1 / (d1 - d3)), 3};
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp);
  const double d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return {c, 2};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return {a + ac * (d2 / (d2 - d6)), 5};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    return {b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))), 4};
  }
  const double scale = 1.0 / (va + vb + vc);
  return {a + ab * (vb * scale) + ac * (vc * scale), 6};
}

/// Unit normal of a triangle that is counter-clockwise from outside; zero for one without area.
inline Vec3 triangle_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = (b - a).cross(c - a);
  const double length = n.norm();
  return length > 0.0 ? Vec3(n / length) : Vec3(Vec3::Zero());
}

/// Unit normal of the edge between two faces, from theirs; that of `face` where they are folded
/// onto each other.
inline Vec3 edge_pseudonormal(const Vec3& face, const Vec3& other) {
  const Vec3 sum = face + other;
  return sum.squaredNorm() > 1e-20 ? Vec3(sum.normalized()) : face;
}

}  // namespace gotai::voxel
