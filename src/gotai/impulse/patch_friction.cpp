#include "gotai/impulse/patch_friction.h"

#include <algorithm>

namespace gotai::impulse {
namespace {

// Below this [m/s] a contact counts as sticking: its direction of sliding is rounding error.
constexpr double no_sliding = 1e-14;

// Force and torque about a body's centre of mass.
struct Wrench {
  Vec3 force = Vec3::Zero();
  Vec3 torque = Vec3::Zero();

  void add(const Vec3& f, const Vec3& arm) {
    force += f;
    torque += arm.cross(f);
  }
};

void act(const model::BodyState& bodies, model::BodyIndex i, double scale, const Wrench& wrench,
         WorkingVelocities& velocities) {
  if (!bodies.is_dynamic(i)) return;
  velocities.v_W[i] += scale * bodies.inverse_mass[i] * wrench.force;
  velocities.w_W[i] += scale * (bodies.inverse_I_W[i] * wrench.torque);
}

double response(const model::BodyState& bodies, model::BodyIndex i, const Wrench& wrench) {
  if (!bodies.is_dynamic(i)) return 0.0;
  return bodies.inverse_mass[i] * wrench.force.squaredNorm() +
         wrench.torque.dot(bodies.inverse_I_W[i] * wrench.torque);
}

}  // namespace

void WorkingVelocities::read(const model::BodyState& bodies) {
  v_W = bodies.v_W;
  w_W = bodies.w_W;
}

Vec3 WorkingVelocities::relative(const model::BodyState& bodies, const model::ContactPair& pair,
                                 const Vec3& point_W) const {
  const auto at = [&](model::BodyIndex i) {
    return (v_W[i] + w_W[i].cross(point_W - bodies.x_W[i])).eval();
  };
  return at(pair.body_a) - at(pair.body_b);
}

void WorkingVelocities::add_impulse(const model::BodyState& bodies, const model::ContactPair& pair,
                                    const Vec3& point_W, const Vec3& impulse_W) {
  const auto act = [&](model::BodyIndex i, const Vec3& impulse) {
    if (!bodies.is_dynamic(i)) return;
    v_W[i] += bodies.inverse_mass[i] * impulse;
    w_W[i] += bodies.inverse_I_W[i] * (point_W - bodies.x_W[i]).cross(impulse);
  };
  act(pair.body_a, impulse_W);
  act(pair.body_b, -impulse_W);
}

void WorkingVelocities::write_changes(const model::BodyState& bodies, model::Update& update) const {
  for (model::BodyIndex i = 0; i < bodies.size(); ++i) {
    if (!bodies.is_dynamic(i)) continue;
    const Vec3 dv = v_W[i] - bodies.v_W[i];
    const Vec3 dw = w_W[i] - bodies.w_W[i];
    if (dv.isZero(0.0) && dw.isZero(0.0)) continue;
    update.delta_v[i] += dv;
    update.delta_L[i] += model::angular_momentum(bodies, i, dw);
  }
}

void add_normal_impulses(const model::BodyState& bodies, const model::ContactSet& contacts,
                         const model::ContactPair& pair, const std::vector<double>& normal_impulse,
                         WorkingVelocities& velocities, std::vector<Vec3>& contact_impulse) {
  Wrench on_a;
  Wrench on_b;
  for (std::uint32_t i = pair.begin; i < pair.end; ++i) {
    if (normal_impulse[i] == 0.0) continue;
    const Vec3 impulse = normal_impulse[i] * contacts.normal_W[i];
    on_a.add(impulse, contacts.point_W[i] - bodies.x_W[pair.body_a]);
    on_b.add(-impulse, contacts.point_W[i] - bodies.x_W[pair.body_b]);
    contact_impulse[i] += impulse;
  }
  act(bodies, pair.body_a, 1.0, on_a, velocities);
  act(bodies, pair.body_b, 1.0, on_b, velocities);
}

void add_patch_friction(const model::BodyState& bodies, const model::ContactSet& contacts,
                        const model::ContactPair& pair, double friction,
                        const std::vector<double>& normal_impulse, WorkingVelocities& velocities,
                        std::vector<Vec3>& contact_impulse) {
  if (friction == 0.0) return;
  velocities.sliding_friction.resize(pair.size());
  Wrench on_a;
  Wrench on_b;
  double power = 0.0;
  for (std::uint32_t i = pair.begin; i < pair.end; ++i) {
    Vec3& friction_i = velocities.sliding_friction[i - pair.begin];
    friction_i.setZero();
    if (normal_impulse[i] <= 0.0) continue;
    const Vec3& n = contacts.normal_W[i];
    const Vec3& x = contacts.point_W[i];
    const Vec3 slip = velocities.relative(bodies, pair, x);
    const Vec3 tangential = slip - n.dot(slip) * n;
    const double speed = tangential.norm();
    if (speed < no_sliding) continue;
    friction_i = -friction * normal_impulse[i] / speed * tangential;
    power += friction_i.dot(slip);
    on_a.add(friction_i, x - bodies.x_W[pair.body_a]);
    on_b.add(-friction_i, x - bodies.x_W[pair.body_b]);
  }
  const double quadratic =
      response(bodies, pair.body_a, on_a) + response(bodies, pair.body_b, on_b);
  if (power >= 0.0 || quadratic <= 0.0) return;
  const double lambda = std::min(1.0, -power / quadratic);

  for (std::uint32_t i = pair.begin; i < pair.end; ++i) {
    contact_impulse[i] += lambda * velocities.sliding_friction[i - pair.begin];
  }
  act(bodies, pair.body_a, lambda, on_a, velocities);
  act(bodies, pair.body_b, lambda, on_b, velocities);
}

}  // namespace gotai::impulse
