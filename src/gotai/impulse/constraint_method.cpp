#include "gotai/impulse/constraint_method.h"

#include <algorithm>
#include <cmath>

#include "gotai/core/parallel.h"
#include "gotai/impulse/contact_kinematics.h"
#include "gotai/impulse/gauss_seidel_solver.h"
#include "gotai/impulse/warm_start.h"

namespace gotai::impulse {
namespace {

constexpr double exact_tolerance = 1e-13;        // of the island's velocity scale
constexpr std::size_t exact_up_to_bodies = 100;  // solver = "auto"

// How far contacts must be seen before they touch [m]. Spheres: the thesis lets them touch first.
double margin(const model::Settings& settings, const model::BodyState& bodies, double dt) {
  if (settings.collision.model == model::CollisionModel::spheres) return 0.0;
  double fastest = 0.0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies.kind[i] == model::BodyKind::fixed) continue;
    fastest =
        std::max(fastest, bodies.v_W[i].norm() + bodies.bounding_radius[i] * bodies.w_W[i].norm());
  }
  return 2.0 * dt * (fastest + settings.gravity.norm() * dt);
}

}  // namespace

ConstraintMethod::ConstraintMethod(const model::Settings& settings) : settings_(settings) {}

model::StepPlan ConstraintMethod::plan(const model::BodyState& bodies, double dt) const {
  model::StepPlan plan;
  plan.dt = dt;
  plan.contact_margin = margin(settings_, bodies, dt);
  plan.positions_first = settings_.time.integrator == model::Integrator::explicit_euler;
  return plan;
}

void ConstraintMethod::prepare(const model::BodyState& bodies, const model::ContactSet& contacts,
                               const model::MaterialTable& materials, const model::StepPlan& plan,
                               const model::ContactMemory& memory) {
  contacts_ = &contacts;
  dt_ = plan.dt;
  read_targets(bodies, contacts, materials, targets_);
  recall(memory, contacts, warm_impulse_);
  islands_ = find_islands(bodies, contacts);
  work_.resize(std::max(work_.size(), islands_.size()));
}

void ConstraintMethod::solve(const model::BodyState& bodies, const std::vector<double>& gap,
                             model::Update& update) {
  parallel_for(islands_.size(), 1,
               [&](std::size_t k) { solve_island(bodies, islands_[k], gap, work_[k]); });

  report_ = {};
  report_.islands = static_cast<std::uint32_t>(islands_.size());
  for (std::size_t k = 0; k < islands_.size(); ++k) {
    const Work& work = work_[k];
    std::size_t row = 0;
    for (const std::uint32_t index : islands_[k].pairs) {
      const model::ContactPair& pair = contacts_->pairs[index];
      for (std::uint32_t i = pair.begin; i < pair.end; ++i, ++row) {
        const Vec3 impulse = work.frame[row] * work.solution.p[row];
        update.contact_impulse[i] += impulse;
        add_impulse(bodies, pair, contacts_->point_W[i], impulse, update);
      }
    }
    report_.rows += static_cast<std::uint32_t>(row);
    report_.residual = std::max(report_.residual, work.solution.residual);
    report_.iterations =
        std::max(report_.iterations, static_cast<std::uint32_t>(work.solution.iterations));
  }
}

void ConstraintMethod::solve_island(const model::BodyState& bodies, const Island& island,
                                    const std::vector<double>& gap, Work& work) const {
  assemble(bodies, *contacts_, island, targets_, gap, dt_, settings_.gravity.norm(),
           settings_.impulse.ridge, work.problem, work.frame);
  work.guess.clear();
  bool warm = false;
  for (const std::uint32_t index : island.pairs) {
    const model::ContactPair& pair = contacts_->pairs[index];
    for (std::uint32_t i = pair.begin; i < pair.end; ++i) {
      warm = warm || !warm_impulse_[i].isZero(0.0);
      work.guess.push_back(work.frame[work.guess.size()].transpose() * warm_impulse_[i]);
    }
  }
  const std::vector<Vec3>* guess = warm ? &work.guess : nullptr;
  const double scale = velocity_scale(work.problem);
  const bool exact = settings_.impulse.solver == model::SolverName::exact ||
                     (settings_.impulse.solver == model::SolverName::automatic &&
                      island.bodies.size() <= exact_up_to_bodies);
  if (exact) {
    solve_exact(work.problem, guess, exact_tolerance * scale, work.solution);
  } else {
    GaussSeidelSolver().solve(work.problem, guess, settings_.impulse.tolerance * scale,
                              settings_.impulse.max_iterations, work.solution);
  }
}

void ConstraintMethod::finish(const model::BodyState& /*bodies*/, model::Update& update,
                              model::ContactMemory& memory) {
  remember(*contacts_, update.contact_impulse, memory);
}

}  // namespace gotai::impulse
