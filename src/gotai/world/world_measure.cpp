// Measurements, state and its hash.
#include <string>

#include "gotai/core/error.h"
#include "gotai/world/measure.h"
#include "gotai/world/world.h"

namespace gotai {

model::Energy World::energy() const {
  return measure_energy(bodies_, settings_, method_->plan(bodies_, last_dt_).substep_dt());
}

Vec3 World::momentum() const {
  Vec3 sum = Vec3::Zero();
  for (model::BodyIndex i = 0; i < bodies_.size(); ++i)
    if (bodies_.is_dynamic(i)) sum += bodies_.v_W[i] / bodies_.inverse_mass[i];
  return sum;
}

Vec3 World::angular_momentum() const {
  Vec3 sum = Vec3::Zero();
  for (model::BodyIndex i = 0; i < bodies_.size(); ++i)
    if (bodies_.is_dynamic(i))
      sum += bodies_.x_W[i].cross(bodies_.v_W[i]) / bodies_.inverse_mass[i] + bodies_.L_W[i];
  return sum;
}

Snapshot World::snapshot() const {
  return {time_,       last_dt_,    step_count_, bodies_.x_W, bodies_.q_WB,
          bodies_.v_W, bodies_.L_W, bodies_.w_W, memory_,     anchors_};
}

void World::restore(const Snapshot& s) {
  for (const std::size_t size :
       {s.x_W.size(), s.q_WB.size(), s.v_W.size(), s.L_W.size(), s.w_W.size()})
    if (size != bodies_.size())
      throw InvalidArgument("snapshot", std::to_string(size) + " bodies",
                            "the world has " + std::to_string(bodies_.size()));
  time_ = s.time;
  last_dt_ = s.last_dt;
  step_count_ = s.step_count;
  bodies_.x_W = s.x_W;
  bodies_.q_WB = s.q_WB;
  bodies_.v_W = s.v_W;
  bodies_.L_W = s.L_W;
  bodies_.w_W = s.w_W;
  memory_ = s.memory;
  anchors_ = s.anchors;
  for (model::BodyIndex i = 0; i < bodies_.size(); ++i) model::refresh_derived(bodies_, i);
  contacts_.clear();
  update_.reset(bodies_.size(), 0);
}

Hash128 World::state_hash() const {
  Hasher hasher;
  hasher.value(time_).value(last_dt_).value(step_count_);
  const auto add = [&hasher](const auto& column) {
    hasher.array(std::span(column.data(), column.size()));
  };
  add(bodies_.x_W);
  add(bodies_.q_WB);
  add(bodies_.v_W);
  add(bodies_.L_W);
  add(bodies_.w_W);
  for (const model::ContactMemory::Entry& e : memory_.entries)
    hasher.value(e.body_a).value(e.body_b).value(e.feature).value(e.impulse_W);
  for (const model::ContactAnchors::Pair& pair : anchors_.pairs) {
    hasher.value(pair.body_a).value(pair.body_b).value(pair.X_BA.p).value(pair.X_BA.q.coeffs());
    hasher.value(pair.reach);
    for (const model::ContactAnchors::Contact& c : pair.contacts) {
      hasher.value(c.point_A).value(c.point_B).value(c.normal_B).value(c.friction_A);
      hasher.value(c.area).value(c.feature);
    }
  }
  return hasher.digest();
}

model::ContactSet World::find_contacts_now() const {
  model::ContactSet contacts;
  collision::CollisionCache cache;
  collision::find_contacts(bodies_, shapes_, settings_.collision, 0.0, cache, contacts);
  return contacts;
}

std::vector<collision::PairOverlap> World::find_overlaps_now() const {
  return collision::find_overlaps(bodies_, shapes_, settings_.collision);
}

}  // namespace gotai
