#include "gotai/dynamics/integrate.h"

#include <algorithm>
#include <array>
#include <span>

#include "gotai/core/parallel.h"
#include "gotai/dynamics/rotation.h"
#include "gotai/dynamics/rotation_kernel.h"

namespace gotai::dynamics {
namespace {

constexpr std::size_t kGrain = 256;     // bodies per task: a body costs less than 0.01 us
constexpr std::size_t kGroupGrain = 8;  // groups of lanes per task: a group costs about 0.2 us

template <std::size_t kCount, typename Column>
void set_lane(RotationLanes::Row (&rows)[kCount], std::size_t l, const Column& column) {
  for (std::size_t c = 0; c < kCount; ++c) rows[c].lane[l] = column[static_cast<Eigen::Index>(c)];
}
/// Rotates dynamic bodies freely, and refreshes what follows from their orientation.
/// @param which  at most as many as there are lanes
void rotate_bodies(model::BodyState& bodies, std::span<const model::BodyIndex> which, double dt) {
  RotationLanes lanes;
  for (std::size_t l = 0; l < kRotationLanes; ++l) {
    const model::BodyIndex i = which[std::min(l, which.size() - 1)];
    set_lane(lanes.q_WB, l, bodies.q_WB[i].coeffs());
    set_lane(lanes.q_BP, l, bodies.q_BP[i].coeffs());
    set_lane(lanes.L_W, l, bodies.L_W[i]);
    set_lane(lanes.principal_moments, l, bodies.principal_moments[i]);
  }
  rotate_free(lanes, dt);
  for (std::size_t l = 0; l < which.size(); ++l) {
    const model::BodyIndex i = which[l];
    const auto& q = lanes.q_WB;
    bodies.q_WB[i] = {q[3].lane[l], q[0].lane[l], q[1].lane[l], q[2].lane[l]};
    const auto& inverse_I = lanes.inverse_I_W;
    const double xx = inverse_I[0].lane[l], xy = inverse_I[1].lane[l], xz = inverse_I[2].lane[l];
    const double yy = inverse_I[3].lane[l], yz = inverse_I[4].lane[l], zz = inverse_I[5].lane[l];
    bodies.inverse_I_W[i] << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    bodies.w_W[i] = {lanes.w_W[0].lane[l], lanes.w_W[1].lane[l], lanes.w_W[2].lane[l]};
  }
}

/// Poses of bodies [first, end), at most as many as there are lanes.
void advance_group(model::BodyState& bodies, const model::Update& update, model::BodyIndex first,
                   model::BodyIndex end, double dt) {
  std::array<model::BodyIndex, kRotationLanes> dynamic;
  std::size_t count = 0;
  for (model::BodyIndex i = first; i < end; ++i) {
    if (bodies.kind[i] == model::BodyKind::fixed) continue;
    bodies.x_W[i] += dt * bodies.v_W[i];
    if (bodies.is_dynamic(i)) {
      dynamic[count++] = i;
    } else {
      bodies.q_WB[i] = rotate(bodies.q_WB[i], bodies.w_W[i], dt);
    }
  }
  if (count == 0) return;
  rotate_bodies(bodies, std::span(dynamic).first(count), dt);
  if (update.push_v.empty()) return;
  for (const model::BodyIndex i : std::span(dynamic).first(count)) {
    bodies.x_W[i] += dt * update.push_v[i];
    bodies.q_WB[i] = rotate(bodies.q_WB[i], update.push_w[i], dt);
    model::refresh_derived(bodies, i);
  }
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
  const std::size_t groups = (bodies.size() + kRotationLanes - 1) / kRotationLanes;
  parallel_for(groups, kGroupGrain, [&](std::size_t g) {
    const std::size_t end = std::min(bodies.size(), (g + 1) * kRotationLanes);
    advance_group(bodies, update, static_cast<model::BodyIndex>(g * kRotationLanes),
                  static_cast<model::BodyIndex>(end), dt);
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
