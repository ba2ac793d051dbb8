/// @file
/// The bodies of a world as a structure of arrays: one column per body.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gotai/core/types.h"

namespace gotai::model {

using BodyIndex = std::uint32_t;  ///< Column in BodyState. Changes when earlier bodies are removed.

/// How a body moves.
enum class BodyKind : std::uint8_t {
  dynamic,    ///< by forces and impulses
  fixed,      ///< never
  kinematic,  ///< along key frames; pushes others, is never pushed
};

/// What a body is made of, geometrically.
enum class Geometry : std::uint8_t {
  shape,      ///< a prepared shape (BodyState::shape is its index)
  plane,      ///< half space below the body frame's x-y plane; its normal is the frame's +z
  container,  ///< open-top box: floor at the body frame's z = 0, four walls
              ///< (BodyState::half_extent)
};

/// State and constants of all bodies. Body frame B: origin at the centre of mass, axes parallel to
/// the mesh frame M. World frame W. Fixed and kinematic bodies, planes and containers are bodies
/// with inverse mass 0, so that there is one code path.
struct BodyState {
  // State: saved, hashed, enough to resume bit for bit (docs/architecture.md, "What is state").
  std::vector<Vec3> x_W;   ///< centre of mass [m], W; written by the integrator
  std::vector<Quat> q_WB;  ///< orientation, unit; written by the integrator
  std::vector<Vec3>
      v_W;  ///< velocity of the centre of mass [m/s], W; written by integrator and impulses
  std::vector<Vec3> L_W;  ///< angular momentum about the centre of mass [kg m^2/s], W; likewise.
                          ///< For bodies with inverse mass 0: unused, 0.

  // Constants: written by add_body.
  std::vector<double> inverse_mass;     ///< [1/kg]; 0 for bodies that impulses do not move
  std::vector<Mat3> I_B;                ///< inertia about the centre of mass [kg m^2], B
  std::vector<Vec3> principal_moments;  ///< eigenvalues of I_B [kg m^2], ascending
  std::vector<Quat> q_BP;               ///< principal axes P in B
  std::vector<Vec3> p_MB;               ///< centre of mass in the mesh frame [m], M
  std::vector<double>
      bounding_radius;               ///< rho: farthest contact surface from the centre of mass [m]
  std::vector<double> voxel_radius;  ///< radius of a voxel sphere at the level in use [m]
  std::vector<Vec3> half_extent;     ///< containers: inner half edges x, y and the height z [m]
  std::vector<std::uint32_t> shape;  ///< index into the world's shapes
  std::vector<std::uint32_t> material;  ///< index into the world's materials
  std::vector<BodyKind> kind;
  std::vector<Geometry> geometry;

  // Derived for dynamic bodies, written by refresh_derived(); given for kinematic ones, so saved
  // too.
  std::vector<Vec3> w_W;  ///< angular velocity [rad/s], W; inverse_I_W L_W for dynamic bodies

  // Derived: never saved; written by refresh_derived().
  std::vector<Mat3> inverse_I_W;  ///< inverse inertia [1/(kg m^2)], W; 0 for inverse mass 0

  std::size_t size() const { return x_W.size(); }
  bool is_dynamic(BodyIndex i) const { return inverse_mass[i] > 0.0; }
  /// Pose of the mesh frame in the world.
  Pose mesh_pose(BodyIndex i) const { return {x_W[i] - q_WB[i] * p_MB[i], q_WB[i]}; }
};

/// Appends one column with defaults (a fixed body at the origin) and returns its index.
BodyIndex append_body(BodyState& bodies);
/// Removes a column; later bodies move up by one.
void erase_body(BodyState& bodies, BodyIndex index);
/// Sets mass and inertia, and what follows from them (inverse mass, principal axes).
/// @param mass     [kg], > 0
/// @param I_B      about the centre of mass [kg m^2]
/// @throws InvalidArgument when the mass is not positive or the inertia not positive definite
void set_mass(BodyState& bodies, BodyIndex index, double mass, const Mat3& I_B);
/// Recomputes inverse_I_W and w_W of one body from its orientation and angular momentum.
void refresh_derived(BodyState& bodies, BodyIndex index);
/// I_W w for a dynamic body: the angular momentum that belongs to an angular velocity [kg m^2/s].
inline Vec3 angular_momentum(const BodyState& bodies, BodyIndex index, const Vec3& w_W) {
  const Quat& q = bodies.q_WB[index];
  return q * (bodies.I_B[index] * (q.conjugate() * w_W));
}
/// Checks sizes, finiteness, unit quaternions.
/// @throws SimulationError naming body and array
void validate(const BodyState& bodies);

}  // namespace gotai::model
