#include "gotai/impulse/island_solver.h"

#include <algorithm>
#include <utility>

#include "gotai/core/parallel.h"
#include "gotai/impulse/contact_kinematics.h"
#include "gotai/impulse/exact_solver.h"
#include "gotai/impulse/gauss_seidel_solver.h"
#include "gotai/impulse/warm_start.h"

namespace gotai::impulse {
namespace {

// Residual of an exact solution that counts as none, as a fraction of the velocity scale.
constexpr double unsolved_residual = 1e-6;

}  // namespace

bool uses_exact_solver(const ConeProblem& problem, const model::ImpulseSettings& settings) {
  return settings.solver == model::SolverName::exact ||
         (settings.solver == model::SolverName::automatic && problem.blocks <= exact_up_to_bodies);
}

void solve_by_settings(const ConeProblem& problem, const std::vector<Vec3>* guess,
                       const model::ImpulseSettings& settings, ConeSolution& solution) {
  constexpr double exact_tolerance = 1e-13;  // of the velocity scale: rounding error
  const double scale = velocity_scale(problem);
  if (uses_exact_solver(problem, settings)) {
    solve_exact(problem, guess, exact_tolerance * scale, solution);
  } else {
    GaussSeidelSolver().solve(problem, guess, settings.tolerance * scale, settings.max_iterations,
                              solution);
  }
}

void IslandSolver::prepare(const model::BodyState& bodies, const model::ContactSet& contacts,
                           const model::ContactMemory& memory) {
  contacts_ = &contacts;
  recall(memory, contacts, warm_impulse_);
  find_islands(bodies, contacts, islands_);
  work_.resize(std::max(work_.size(), islands_.size()));
}

void IslandSolver::solve(const model::BodyState& bodies, const ContactTargets& targets,
                         const std::vector<double>& gap, double dt, model::Update& update) {
  parallel_for(islands_.size(), 1, [&](std::size_t k) {
    solve_island(bodies, islands_[k], targets, gap, dt, work_[k]);
  });

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
        // Friction acts elsewhere when the contact stands for others.
        const Vec3 friction = impulse - work.frame[row].col(0) * work.solution.p[row].x();
        const Vec3 moment = (targets.friction_W[i] - contacts_->point_W[i]).cross(friction);
        if (bodies.is_dynamic(pair.body_a)) update.delta_L[pair.body_a] += moment;
        if (bodies.is_dynamic(pair.body_b)) update.delta_L[pair.body_b] -= moment;
      }
    }
    report_.rows += static_cast<std::uint32_t>(row);
    report_.plastic_islands += work.plastic ? 1 : 0;
    report_.residual = std::max(report_.residual, work.solution.residual);
    report_.iterations =
        std::max(report_.iterations, static_cast<std::uint32_t>(work.solution.iterations));
  }
}

void IslandSolver::solve_island(const model::BodyState& bodies, const Island& island,
                                const ContactTargets& targets, const std::vector<double>& gap,
                                double dt, Work& work) const {
  assemble(bodies, *contacts_, island, targets, gap, dt, settings_.gravity.norm(),
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
  solve_by_settings(work.problem, warm ? &work.guess : nullptr, settings_.impulse, work.solution);
  work.plastic = false;
  const double unsolved = unsolved_residual * velocity_scale(work.problem);
  if (work.solution.residual > unsolved && uses_exact_solver(work.problem, settings_.impulse)) {
    solve_plastic(bodies, island, targets, gap, dt, work);
  }
}

// With e = 0 the contact problem always has a solution; with restitution and friction bodies that
// are wedged may leave none.
void IslandSolver::solve_plastic(const model::BodyState& bodies, const Island& island,
                                 ContactTargets targets, const std::vector<double>& gap, double dt,
                                 Work& work) const {
  std::fill(targets.restitution.begin(), targets.restitution.end(), 0.0);
  assemble(bodies, *contacts_, island, targets, gap, dt, settings_.gravity.norm(),
           settings_.impulse.ridge, work.problem, work.frame);
  ConeSolution plastic;
  solve_by_settings(work.problem, nullptr, settings_.impulse, plastic);
  work.plastic = plastic.residual < work.solution.residual;
  if (work.plastic) work.solution = std::move(plastic);
}

}  // namespace gotai::impulse
