/// @file
/// Short names for the linear algebra types that every module uses. Double precision throughout.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>

namespace gotai {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
/// Unit quaternion; written w, x, y, z in every file and on every command line.
using Quat = Eigen::Quaterniond;

/// Rigid transform that maps coordinates of frame B into frame A: x_A = q_AB * x_B + p_AB.
struct Pose {
  Vec3 p = Vec3::Zero();      ///< Position of B's origin in A [m].
  Quat q = Quat::Identity();  ///< Rotation of B in A.

  Vec3 operator*(const Vec3& x_B) const { return q * x_B + p; }
  Pose operator*(const Pose& X_BC) const { return {q * X_BC.p + p, q * X_BC.q}; }
  Pose inverse() const { return {-(q.conjugate() * p), q.conjugate()}; }
};

/// Axis-aligned box. Empty when min > max.
using Box3 = Eigen::AlignedBox3d;

}  // namespace gotai
