#include "gotai/dynamics/integrate.h"

#include <cmath>

#include "gotai/core/parallel.h"
#include "gotai/dynamics/rotation.h"

namespace gotai::dynamics {
namespace {

constexpr std::size_t kGrain = 256;  // bodies per task: a body costs about 0.1 us

Quat axis_rotation(int axis, double angle) {
  Quat q(std::cos(0.5 * angle), 0.0, 0.0, 0.0);
  q.vec()[axis] = std::sin(0.5 * angle);
  return q;
}

/// Torque-free rotation that conserves L. The kinetic energy is split into a sphere with the middle
/// principal moment, whose flow turns about the fixed L exactly, and the two remaining axes, whose
/// flows turn about a body axis exactly; Strang composition of these is symplectic, of second
/// order, and exact for spheres and symmetric tops (erratum 26).
Quat rotate_free(const model::BodyState& bodies, model::BodyIndex i, double dt) {
  const Vec3& moments = bodies.principal_moments[i];
  const Quat& q_WB = bodies.q_WB[i];
  const Quat& q_BP = bodies.q_BP[i];
  const double inverse_middle = 1.0 / moments[1];
  Vec3 L_P = q_BP.conjugate() * (q_WB.conjugate() * bodies.L_W[i]);
  Quat turn_P = Quat::Identity();
  const auto turn = [&](int axis, double time) {
    const double angle = time * (1.0 / moments[axis] - inverse_middle) * L_P[axis];
    const Quat rotation = axis_rotation(axis, angle);
    turn_P = turn_P * rotation;
    L_P = rotation.conjugate() * L_P;
  };
  turn(0, 0.5 * dt);
  turn(2, dt);
  turn(0, 0.5 * dt);
  Quat turn_B = turn_P;
  turn_B.vec() = q_BP * turn_P.vec();
  const Vec3 sphere_spin = inverse_middle * bodies.L_W[i];
  return (rotation_increment(sphere_spin, dt) * q_WB * turn_B).normalized();
}

}  // namespace

void advance_velocities(model::BodyState& bodies, const Vec3& gravity, const Loads& loads,
                        double dt) {
  parallel_for(bodies.size(), kGrain, [&](std::size_t k) {
    const auto i = static_cast<model::BodyIndex>(k);
    if (!bodies.is_dynamic(i)) return;
    bodies.v_W[i] += dt * (gravity + bodies.inverse_mass[i] * loads.force[i]);
    bodies.L_W[i] += dt * loads.torque[i];
    bodies.w_W[i] = bodies.inverse_I_W[i] * bodies.L_W[i];
  });
}

void apply_update(model::BodyState& bodies, const model::Update& update) {
  parallel_for(bodies.size(), kGrain, [&](std::size_t k) {
    const auto i = static_cast<model::BodyIndex>(k);
    if (!bodies.is_dynamic(i)) return;
    bodies.v_W[i] += update.delta_v[i];
    bodies.L_W[i] += update.delta_L[i];
    bodies.w_W[i] = bodies.inverse_I_W[i] * bodies.L_W[i];
  });
}

void advance_poses(model::BodyState& bodies, const model::Update& update, double dt) {
  parallel_for(bodies.size(), kGrain, [&](std::size_t k) {
    const auto i = static_cast<model::BodyIndex>(k);
    if (bodies.kind[i] == model::BodyKind::fixed) return;
    bodies.x_W[i] += dt * bodies.v_W[i];
    if (!bodies.is_dynamic(i)) {
      bodies.q_WB[i] = rotate(bodies.q_WB[i], bodies.w_W[i], dt);
      return;
    }
    bodies.q_WB[i] = rotate_free(bodies, i, dt);
    if (!update.push_v.empty()) {
      bodies.x_W[i] += dt * update.push_v[i];
      bodies.q_WB[i] = rotate(bodies.q_WB[i], update.push_w[i], dt);
    }
    model::refresh_derived(bodies, i);
  });
}

void advance_poses_explicit(model::BodyState& bodies, double dt) {
  parallel_for(bodies.size(), kGrain, [&](std::size_t k) {
    const auto i = static_cast<model::BodyIndex>(k);
    if (bodies.kind[i] == model::BodyKind::fixed) return;
    bodies.x_W[i] += dt * bodies.v_W[i];
    bodies.q_WB[i] = rotate(bodies.q_WB[i], bodies.w_W[i], dt);
    if (!bodies.is_dynamic(i)) return;
    // The thesis keeps w constant; L has to follow the turned inertia.
    bodies.L_W[i] = model::angular_momentum(bodies, i, bodies.w_W[i]);
    model::refresh_derived(bodies, i);
  });
}

}  // namespace gotai::dynamics
