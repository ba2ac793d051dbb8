#include "gotai/dynamics/integrate.h"

#include "gotai/core/parallel.h"
#include "gotai/dynamics/rotation.h"

namespace gotai::dynamics {
namespace {

constexpr std::size_t kGrain = 256;  // bodies per task: a body costs about 0.1 us

/// Torque-free rotation that conserves L. The kinetic energy is split into a sphere with the middle
/// principal moment, whose flow turns about the fixed L exactly, and the two remaining axes, whose
/// flows turn about a body axis exactly; Strang composition of these is symplectic, of second
/// order, and exact for spheres and symmetric tops (erratum 26).
Quat rotate_free(const model::BodyState& bodies, model::BodyIndex i, double dt) {
  const Vec3 inverse_moments = bodies.principal_moments[i].cwiseInverse();
  const Quat q_WP = bodies.q_WB[i] * bodies.q_BP[i];
  Vec3 L_P = q_WP.conjugate() * bodies.L_W[i];
  Quat turn_P = Quat::Identity();
  // Turns about a principal axis, with the coordinates across it in positive order.
  const auto turn = [&](int axis, int next, int last, double time) {
    const double half_angle = 0.5 * time * (inverse_moments[axis] - inverse_moments[1]) * L_P[axis];
    const auto [c, sinc] = cosine_and_sinc(half_angle * half_angle);
    const double s = half_angle * sinc;
    const double w = turn_P.w();
    const Vec3 v = turn_P.vec();
    turn_P.w() = w * c - v[axis] * s;
    turn_P.vec()[axis] = w * s + v[axis] * c;
    turn_P.vec()[next] = v[next] * c + v[last] * s;
    turn_P.vec()[last] = v[last] * c - v[next] * s;
    const double cosine = c * c - s * s;
    const double sine = 2.0 * c * s;
    const double L_next = L_P[next];
    L_P[next] = cosine * L_next + sine * L_P[last];
    L_P[last] = cosine * L_P[last] - sine * L_next;
  };
  turn(0, 1, 2, 0.5 * dt);
  turn(2, 0, 1, dt);
  turn(0, 1, 2, 0.5 * dt);
  const Quat sphere = rotation_increment(inverse_moments[1] * bodies.L_W[i], dt);
  return (sphere * (q_WP * turn_P) * bodies.q_BP[i].conjugate()).normalized();
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
