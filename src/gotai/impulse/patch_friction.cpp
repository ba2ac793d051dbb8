#include "gotai/impulse/patch_friction.h"

#include <algorithm>

namespace gotai::impulse {
namespace {

// Below this [m/s] a contact counts as sticking: its direction of sliding is rounding error.
constexpr double no_sliding = 1e-14;

// Force and torque about a body's centre of mass that unit friction has.
struct Wrench {
  Vec3 force = Vec3::Zero();
  Vec3 torque = Vec3::Zero();
};

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
    update.delta_v[i] += v_W[i] - bodies.v_W[i];
    update.delta_L[i] += model::angular_momentum(bodies, i, w_W[i] - bodies.w_W[i]);
  }
}

void add_normal_impulses(const model::BodyState& bodies, const model::ContactSet& contacts,
                         const model::ContactPair& pair, const std::vector<double>& normal_impulse,
                         WorkingVelocities& velocities, std::vector<Vec3>& contact_impulse) {
  for (std::uint32_t i = pair.begin; i < pair.end; ++i) {
    if (normal_impulse[i] == 0.0) continue;
    const Vec3 impulse = normal_impulse[i] * contacts.normal_W[i];
    velocities.add_impulse(bodies, pair, contacts.point_W[i], impulse);
    contact_impulse[i] += impulse;
  }
}

void add_patch_friction(const model::BodyState& bodies, const model::ContactSet& contacts,
                        const model::ContactPair& pair, double friction,
                        const std::vector<double>& normal_impulse, WorkingVelocities& velocities,
                        std::vector<Vec3>& contact_impulse) {
  if (friction == 0.0) return;
  const auto full_sliding = [&](std::uint32_t i) -> Vec3 {
    if (normal_impulse[i] <= 0.0) return Vec3::Zero();
    const Vec3& n = contacts.normal_W[i];
    const Vec3 slip = velocities.relative(bodies, pair, contacts.point_W[i]);
    const Vec3 tangential = slip - n.dot(slip) * n;
    const double speed = tangential.norm();
    if (speed < no_sliding) return Vec3::Zero();
    return -friction * normal_impulse[i] / speed * tangential;
  };

  Wrench on_a;
  Wrench on_b;
  double power = 0.0;
  for (std::uint32_t i = pair.begin; i < pair.end; ++i) {
    const Vec3 f = full_sliding(i);
    const Vec3& x = contacts.point_W[i];
    power += f.dot(velocities.relative(bodies, pair, x));
    on_a.force += f;
    on_a.torque += (x - bodies.x_W[pair.body_a]).cross(f);
    on_b.force -= f;
    on_b.torque -= (x - bodies.x_W[pair.body_b]).cross(f);
  }
  const double quadratic =
      response(bodies, pair.body_a, on_a) + response(bodies, pair.body_b, on_b);
  if (power >= 0.0 || quadratic <= 0.0) return;
  const double lambda = std::min(1.0, -power / quadratic);

  for (std::uint32_t i = pair.begin; i < pair.end; ++i) {
    contact_impulse[i] += lambda * full_sliding(i);
  }
  const auto act = [&](model::BodyIndex i, const Wrench& wrench) {
    if (!bodies.is_dynamic(i)) return;
    velocities.v_W[i] += lambda * bodies.inverse_mass[i] * wrench.force;
    velocities.w_W[i] += lambda * (bodies.inverse_I_W[i] * wrench.torque);
  };
  act(pair.body_a, on_a);
  act(pair.body_b, on_b);
}

}  // namespace gotai::impulse
