#include "gotai/impulse/impulse_method.h"

#include "gotai/impulse/contact_kinematics.h"
#include "gotai/impulse/step_plans.h"

namespace gotai::impulse {

SuperposedImpulses::SuperposedImpulses(const model::Settings& settings, bool averaged)
    : settings_(settings), averaged_(averaged) {}

model::StepPlan SuperposedImpulses::plan(const model::BodyState& /*bodies*/, double dt) const {
  return whole_step(settings_, dt);
}

void SuperposedImpulses::prepare(const model::BodyState& bodies, const model::ContactSet& contacts,
                                 const model::MaterialTable& materials, const model::StepPlan& plan,
                                 const model::ContactMemory& /*memory*/) {
  contacts_ = &contacts;
  dt_ = plan.dt;
  read_targets(bodies, contacts, materials, targets_);
}

void SuperposedImpulses::solve(const model::BodyState& bodies, const std::vector<double>& gap,
                               model::Update& update) {
  normal_impulse_.assign(contacts_->size(), 0.0);
  velocities_.read(bodies);
  report_ = {};
  for (const model::ContactPair& pair : contacts_->pairs) {
    std::uint32_t firing = 0;
    for (std::uint32_t i = pair.begin; i < pair.end; ++i) {
      const Vec3& x = contacts_->point_W[i];
      const Vec3& n = contacts_->normal_W[i];
      const double v_star = n.dot(relative_velocity(bodies, pair, x));
      const double target = row_bias(targets_.approach[i], v_star, gap[i], targets_.restitution[i],
                                     dt_, settings_.gravity.norm());
      const double missing = -(v_star + target);
      if (missing <= 0.0) continue;
      normal_impulse_[i] = missing / inverse_effective_mass(bodies, pair, x, n);
      ++firing;
    }
    report_.rows += firing;
    if (averaged_ && firing > 0) {
      for (std::uint32_t i = pair.begin; i < pair.end; ++i) normal_impulse_[i] /= firing;
    }
    add_normal_impulses(bodies, *contacts_, pair, normal_impulse_, velocities_,
                        update.contact_impulse);
  }
  for (const model::ContactPair& pair : contacts_->pairs) {
    add_patch_friction(bodies, *contacts_, pair, targets_.friction[pair.begin], normal_impulse_,
                       velocities_, update.contact_impulse);
  }
  velocities_.write_changes(bodies, update);
}

void SuperposedImpulses::finish(const model::BodyState& /*bodies*/, model::Update& /*update*/,
                                model::ContactMemory& memory) {
  memory.entries.clear();
}

}  // namespace gotai::impulse
