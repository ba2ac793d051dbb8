#include "gotai/world/world.h"

#include <algorithm>
#include <string>
#include <utility>

#include "gotai/core/error.h"
#include "gotai/core/stopwatch.h"
#include "gotai/core/thread_team.h"
#include "gotai/dynamics/rotation.h"
#include "gotai/dynamics/step_control.h"
#include "gotai/world/measure.h"
#include "gotai/world/motion.h"

namespace gotai {

World::World(const model::Settings& settings) : settings_(settings) {
  model::validate(settings_);
  method_ = impulse::make_method(settings_);
}

model::StepReport World::step() {
  const ThreadTeam team;
  Stopwatch clock;
  model::StepReport report;
  report.dt =
      settings_.time.step > 0.0 ? settings_.time.step : dynamics::derived_step(bodies_, settings_);
  const model::StepPlan plan = method_->plan(bodies_, report.dt);
  aim_kinematic_bodies(plan.dt);
  report.other_s += clock.lap();

  const collision::SearchStatistics search = collision::find_contacts(
      bodies_, shapes_, settings_.collision, plan.contact_margin, cache_, contacts_,
      {model::contact_treatment(settings_), plan.dt, memory_.entries, &anchors_});
  report.collision_s += clock.lap();

  update_.reset(bodies_.size(), contacts_.size());
  gaps_ = contacts_.gap;
  method_->prepare(bodies_, contacts_, materials_, plan, memory_);
  report.impulse_s += clock.lap();

  for (int k = 0; k < plan.substeps; ++k) {
    if (k > 0 && plan.refresh_contacts) model::refresh_gaps(bodies_, contacts_, gaps_);
    substep(plan, report);
  }

  clock.lap();
  update_.clear_changes();
  method_->finish(bodies_, update_, memory_);
  dynamics::apply_update(bodies_, update_);
  report.impulse_s += clock.lap();

  ++step_count_;
  time_ += plan.dt;
  last_dt_ = plan.dt;
  loads_.force.assign(bodies_.size(), Vec3::Zero());
  loads_.torque.assign(bodies_.size(), Vec3::Zero());
  check_state();
  report.step = step_count_;
  report.time = time_;
  report.tests = search.tests;
  report.solve = method_->report();
  report.energy = measure_energy(bodies_, settings_, plan.substep_dt());
  measure_contacts(contacts_, report);
  report.other_s += clock.lap();
  for (const Observer& observer : observers_) observer(*this, report);
  return report;
}

void World::substep(const model::StepPlan& plan, model::StepReport& report) {
  const double h = plan.substep_dt();
  Stopwatch clock;
  update_.clear_changes();
  if (!plan.positions_first) dynamics::advance_velocities(bodies_, settings_.gravity, loads_, h);
  report.integration_s += clock.lap();

  method_->solve(bodies_, gaps_, update_);
  report.impulse_s += clock.lap();

  if (plan.positions_first) {  // explicit Euler [Makino 2007, eq. 4.19]: gravity comes last
    dynamics::advance_poses_explicit(bodies_, h);
    dynamics::apply_update(bodies_, update_);
    dynamics::advance_velocities(bodies_, settings_.gravity, loads_, h);
  } else {
    dynamics::apply_update(bodies_, update_);
    dynamics::advance_poses(bodies_, update_, h);
  }
  report.integration_s += clock.lap();

  if (plan.relax) {
    update_.clear_changes();
    method_->relax(bodies_, update_);
    dynamics::apply_update(bodies_, update_);
    report.impulse_s += clock.lap();
  }
}

void World::run_until(double end) {
  while (!has_reached(end)) step();
}

void World::aim_kinematic_bodies(double dt) {
  for (const auto& [id, frames] : motions_) {
    const model::BodyIndex i = index(id);
    const Pose target = motion_pose(frames, time_ + dt);
    const Vec3 x_target = target * bodies_.p_MB[i];
    bodies_.v_W[i] = (x_target - bodies_.x_W[i]) / dt;
    bodies_.w_W[i] = rotation_rate(bodies_.q_WB[i], target.q, dt);
  }
}

void World::check_state() const {
  // No body of a sound run crosses ten thousand times its own size within a step.
  constexpr double kMostSizesPerStep = 1e4;
  try {
    model::validate(bodies_);
    for (model::BodyIndex i = 0; i < bodies_.size(); ++i) {
      const double size = bodies_.bounding_radius[i];
      const double speed = bodies_.v_W[i].norm() + size * bodies_.w_W[i].norm();
      if (!bodies_.is_dynamic(i) || speed * last_dt_ <= kMostSizesPerStep * size) continue;
      throw SimulationError("body \"" + names_[i] + "\" moves at " + std::to_string(speed) +
                            " m/s: the energy ran away");
    }
  } catch (const SimulationError& error) {
    throw SimulationError("step " + std::to_string(step_count_) + " (t = " + std::to_string(time_) +
                          " s): " + error.what() +
                          "; check masses, forces and the step size of the scene");
  }
}

}  // namespace gotai
