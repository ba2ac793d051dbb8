/// @file
/// Bodies and contacts made by hand: what impulse methods read, without shapes and collision.
#pragma once

#include <memory>

#include "gotai/impulse/method.h"
#include "gotai/model/body_state.h"
#include "gotai/model/contact_memory.h"
#include "gotai/model/contact_set.h"
#include "gotai/model/material.h"
#include "gotai/model/settings.h"
#include "gotai/model/step.h"

namespace gotai::test {

/// A handful of bodies, their contacts, and one impulse method.
struct ContactScene {
  model::BodyState bodies;
  model::ContactSet contacts;
  model::MaterialTable materials;
  model::ContactMemory memory;
  model::Update update;

  /// @param mass  [kg]; 0 makes a fixed body
  model::BodyIndex add_body(double mass, const Mat3& I_B, const Vec3& x_W, const Vec3& v_W,
                            const Vec3& w_W) {
    const model::BodyIndex i = model::append_body(bodies);
    bodies.x_W[i] = x_W;
    if (mass > 0.0) {
      bodies.kind[i] = model::BodyKind::dynamic;
      model::set_mass(bodies, i, mass, I_B);
      model::refresh_derived(bodies, i);
      bodies.v_W[i] = v_W;
      bodies.L_W[i] = model::angular_momentum(bodies, i, w_W);
    }
    model::refresh_derived(bodies, i);
    return i;
  }
  void set_velocity(model::BodyIndex i, const Vec3& v_W, const Vec3& w_W) {
    bodies.v_W[i] = v_W;
    bodies.L_W[i] = model::angular_momentum(bodies, i, w_W);
    model::refresh_derived(bodies, i);
  }
  void surface(double restitution, double friction) {
    materials.materials[0].restitution = restitution;
    materials.materials[0].friction = friction;
  }
  void begin_pair(model::BodyIndex a, model::BodyIndex b) {
    const auto at = static_cast<std::uint32_t>(contacts.size());
    contacts.pairs.push_back({a, b, at, at});
  }
  /// Appends a contact to the last pair.
  void add_contact(const Vec3& point_W, const Vec3& normal_W, double gap = 0.0, double area = 1.0) {
    const model::ContactPair& pair = contacts.pairs.back();
    const auto local = [&](model::BodyIndex i, const Vec3& x_W) {
      return (bodies.q_WB[i].conjugate() * (x_W - bodies.x_W[i])).eval();
    };
    contacts.push(point_W, normal_W, gap, local(pair.body_a, point_W + 0.5 * gap * normal_W),
                  local(pair.body_b, point_W - 0.5 * gap * normal_W), area, pair.size());
  }
  /// One solve of the method on the present velocities, applied to the bodies.
  /// @param gravity_step  added to the velocities of dynamic bodies between prepare and solve
  model::SolveReport strike(impulse::ImpulseMethod& method, double dt,
                            const Vec3& gravity_step = Vec3::Zero()) {
    const model::StepPlan plan = method.plan(bodies, dt);
    update.reset(bodies.size(), contacts.size());
    method.prepare(bodies, contacts, materials, plan, memory);
    for (model::BodyIndex i = 0; i < bodies.size(); ++i) {
      if (bodies.is_dynamic(i)) bodies.v_W[i] += gravity_step;
    }
    method.solve(bodies, contacts.gap, update);
    apply();
    update.clear_changes();
    method.finish(bodies, update, memory);
    apply();
    return method.report();
  }
  /// Kinetic energy of the dynamic bodies [J].
  double kinetic_energy() const {
    double sum = 0.0;
    for (model::BodyIndex i = 0; i < bodies.size(); ++i) {
      if (!bodies.is_dynamic(i)) continue;
      sum += 0.5 * bodies.v_W[i].squaredNorm() / bodies.inverse_mass[i] +
             0.5 * bodies.w_W[i].dot(bodies.L_W[i]);
    }
    return sum;
  }

 private:
  void apply() {
    for (model::BodyIndex i = 0; i < bodies.size(); ++i) {
      if (!bodies.is_dynamic(i)) continue;
      bodies.v_W[i] += update.delta_v[i];
      bodies.L_W[i] += update.delta_L[i];
      model::refresh_derived(bodies, i);
    }
  }
};

/// Inertia of a solid cube [kg m^2].
inline Mat3 cube_inertia(double mass, double edge) {
  return Mat3::Identity() * (mass * edge * edge / 6.0);
}

/// Settings of one method, gravity 9.8.
inline model::Settings method_settings(
    model::ImpulseMethodName method = model::ImpulseMethodName::constraint,
    model::ContactTreatment contacts = model::ContactTreatment::all,
    model::SolverName solver = model::SolverName::exact) {
  model::Settings settings;
  settings.gravity = Vec3(0.0, 0.0, -9.8);
  settings.collision.model = model::CollisionModel::spheres;
  settings.impulse.method = method;
  settings.impulse.contacts = contacts;
  settings.impulse.solver = solver;
  return settings;
}

}  // namespace gotai::test
