#include "gotai/impulse/apparent_method.h"

#include <algorithm>
#include <cmath>

#include "gotai/impulse/contact_kinematics.h"
#include "gotai/impulse/island_solver.h"
#include "gotai/impulse/row_solver.h"
#include "gotai/impulse/step_plans.h"

namespace gotai::impulse {

ApparentMethod::ApparentMethod(const model::Settings& settings) : settings_(settings) {}

model::StepPlan ApparentMethod::plan(const model::BodyState& /*bodies*/, double dt) const {
  return whole_step(settings_, dt);
}

void ApparentMethod::prepare(const model::BodyState& bodies, const model::ContactSet& contacts,
                             const model::MaterialTable& materials, const model::StepPlan& plan,
                             const model::ContactMemory& /*memory*/) {
  contacts_ = &contacts;
  dt_ = plan.dt;
  read_targets(bodies, contacts, materials, targets_);
  find_islands(bodies, contacts, islands_);
  find_patches(bodies);
}

// A container is one body with several faces, the upper half of a contact's feature: a body in its
// corner touches each of them at an apparent point of its own.
void ApparentMethod::find_patches(const model::BodyState& bodies) {
  patches_.clear();
  first_patch_.assign(1, 0);
  for (const model::ContactPair& pair : contacts_->pairs) {
    const bool faces = bodies.geometry[pair.body_a] == model::Geometry::container ||
                       bodies.geometry[pair.body_b] == model::Geometry::container;
    model::ContactPair patch = pair;
    for (std::uint32_t i = pair.begin + 1; faces && i < pair.end; ++i) {
      if (contacts_->feature[i] >> 32U == contacts_->feature[i - 1] >> 32U) continue;
      patch.end = i;
      patches_.push_back(patch);
      patch.begin = i;
      patch.end = pair.end;
    }
    patches_.push_back(patch);
    first_patch_.push_back(static_cast<std::uint32_t>(patches_.size()));
  }
}

void ApparentMethod::find_weights(const model::BodyState& bodies, const std::vector<double>& gap) {
  v_star_.resize(contacts_->size());
  bias_.resize(contacts_->size());
  apparent_.clear();
  for (const model::ContactPair& pair : patches_) {
    const RelativeMotion motion(bodies, pair);
    for (std::uint32_t i = pair.begin; i < pair.end; ++i) {
      v_star_[i] = motion.along(contacts_->normal_W[i], contacts_->point_W[i]);
      bias_[i] = row_bias(targets_.approach[i], v_star_[i], gap[i], targets_.restitution[i], dt_,
                          settings_.gravity.norm());
    }
    const auto part = [&](const auto& values) {
      return std::span(values).subspan(pair.begin, pair.size());
    };
    apparent_.push_back(
        apparent_contact(part(contacts_->point_W), part(contacts_->normal_W), part(v_star_)));
  }
}

// Few rows converge in a handful of sweeps; where they do not, Newton makes the answer exact.
void ApparentMethod::solve_pairs() {
  const double scale = velocity_scale(problem_);
  if (!uses_exact_solver(problem_, settings_.impulse)) {
    rows_.solve(problem_, settings_.impulse.tolerance * scale, settings_.impulse.max_iterations,
                solution_);
    return;
  }
  constexpr double exact_tolerance = 1e-13;
  constexpr int worthwhile_sweeps = 200;
  rows_.solve(problem_, exact_tolerance * scale, worthwhile_sweeps, solution_);
  if (!solution_.converged) solve_by_settings(problem_, nullptr, settings_.impulse, solution_);
}

// One row per patch with an approaching contact: sum w_i (row of contact i) / scale, as the force
// and the torque that the spread impulses exert.
void ApparentMethod::assemble_pairs(const model::BodyState& bodies, const Island& island) {
  ConeProblem& problem = problem_;
  problem.clear();
  problem.blocks = island.bodies.size();
  problem.y_free.resize(static_cast<Eigen::Index>(6 * problem.blocks));
  inertia_.resize(problem.blocks);
  for (std::size_t b = 0; b < problem.blocks; ++b) {
    const model::BodyIndex i = island.bodies[b];
    inertia_[b] = inertia_scale(bodies.inverse_I_W[i]);
    problem.y_free.segment<6>(static_cast<Eigen::Index>(6 * b))
        << bodies.v_W[i] / std::sqrt(bodies.inverse_mass[i]),
        inertia_[b].transpose() * bodies.L_W[i];
  }
  problem.patch.push_back(0);
  for_each_patch(island, [&](std::uint32_t k) {
    const ApparentContact& apparent = apparent_[k];
    const model::ContactPair& pair = patches_[k];
    Vec3 force = Vec3::Zero();
    Vec3 moment = Vec3::Zero();  // about the apparent point
    double bias = 0.0;
    double v_star = 0.0;
    for (std::uint32_t i = pair.begin; i < pair.end; ++i) {
      const double share = std::max(-v_star_[i], 0.0) / apparent.scale;
      force += share * contacts_->normal_W[i];
      moment += share * (contacts_->point_W[i] - apparent.point).cross(contacts_->normal_W[i]);
      bias += share * bias_[i];
      v_star += share * v_star_[i];
    }
    for (const model::BodyIndex body : {pair.body_a, pair.body_b}) {
      if (!bodies.is_dynamic(body)) continue;
      const double sign = body == pair.body_a ? 1.0 : -1.0;
      const auto at = std::lower_bound(island.bodies.begin(), island.bodies.end(), body);
      const auto block = static_cast<std::uint32_t>(at - island.bodies.begin());
      const Vec3 torque = moment + (apparent.point - bodies.x_W[body]).cross(force);
      Coupling coupling{block, Jacobian::Zero()};
      coupling.J.row(0) << sign * std::sqrt(bodies.inverse_mass[body]) * force.transpose(),
          sign * torque.transpose() * inertia_[block];
      v_star -= coupling.J.row(0).dot(problem.y_free.segment<6>(Eigen::Index{6} * block));
      problem.couplings.push_back(coupling);
    }
    problem.first.push_back(static_cast<std::uint32_t>(problem.couplings.size()));
    // What is left of v_star is the motion of bodies that impulses do not move.
    problem.bias.emplace_back(bias + v_star, 0.0, 0.0);
    problem.friction.push_back(0.0);
    problem.patch.push_back(static_cast<std::uint32_t>(problem.size()));
  });
  area_.assign(problem.size(), 1.0);
  set_compliance(problem, area_, settings_.impulse.ridge);
}

void ApparentMethod::solve(const model::BodyState& bodies, const std::vector<double>& gap,
                           model::Update& update) {
  find_weights(bodies, gap);
  normal_impulse_.assign(contacts_->size(), 0.0);
  velocities_.read(bodies);
  report_ = {};
  report_.islands = static_cast<std::uint32_t>(islands_.size());
  for (const Island& island : islands_) {
    assemble_pairs(bodies, island);
    solve_pairs();
    report_.rows += static_cast<std::uint32_t>(problem_.size());
    report_.residual = std::max(report_.residual, solution_.residual);
    report_.iterations =
        std::max(report_.iterations, static_cast<std::uint32_t>(solution_.iterations));

    std::size_t row = 0;
    for_each_patch(island, [&](std::uint32_t k) {
      const model::ContactPair& pair = patches_[k];
      const double alpha = solution_.p[row++].x() / apparent_[k].scale;  // (5.19)
      for (std::uint32_t i = pair.begin; i < pair.end; ++i) {
        normal_impulse_[i] = alpha * std::max(-v_star_[i], 0.0);
      }
      add_normal_impulses(bodies, *contacts_, pair, normal_impulse_, velocities_,
                          update.contact_impulse);
    });
  }
  for (const model::ContactPair& pair : patches_) {
    add_patch_friction(bodies, *contacts_, pair, targets_.friction[pair.begin], normal_impulse_,
                       velocities_, update.contact_impulse);
  }
  velocities_.write_changes(bodies, update);
}

void ApparentMethod::finish(const model::BodyState& /*bodies*/, model::Update& /*update*/,
                            model::ContactMemory& memory) {
  memory.entries.clear();
}

}  // namespace gotai::impulse
