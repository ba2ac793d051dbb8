#include "gotai/impulse/gauss_seidel_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gotai::impulse {
namespace {

constexpr int first_sweeps = 30;             // contact sweeps of the first round
constexpr double worthwhile_progress = 0.8;  // of a patch sweep: residual after / before

}  // namespace

void GaussSeidelSolver::solve(const ConeProblem& problem, const std::vector<Vec3>* guess,
                              double limit, int max_sweeps, ConeSolution& solution) {
  if (guess != nullptr) {
    solution.p = *guess;
  } else {
    solution.p.assign(problem.size(), Vec3::Zero());
  }
  cut(problem);
  prepare_contacts(problem);
  solution.iterations = 0;
  int sweeps = first_sweeps;
  for (bool first_round = true;; first_round = false, sweeps *= 2) {
    const int last = std::min(max_sweeps, solution.iterations + sweeps);
    sweep_until(problem, limit, last, solution);
    // Patch sweeps go on as long as they pay.
    double before = std::numeric_limits<double>::infinity();
    for (bool all = first_round;; all = false) {
      sweep_patches(problem, limit, all, solution);
      ++solution.iterations;
      solution.y = velocities_of(problem, solution.p);  // no drift from the updates
      solution.residual = natural_map_residual(problem, solution.p, solution.y);
      solution.converged = solution.residual <= limit;
      if (solution.converged || solution.iterations >= max_sweeps) return;
      if (solution.residual > worthwhile_progress * before) break;
      before = solution.residual;
    }
  }
}

void GaussSeidelSolver::prepare_contacts(const ConeProblem& problem) {
  normal_step_.resize(problem.size());
  tangential_step_.resize(problem.size());
  for (std::size_t i = 0; i < problem.size(); ++i) {
    Mat3 A = Mat3::Zero();
    for (std::uint32_t k = problem.first[i]; k < problem.first[i + 1]; ++k) {
      A.noalias() += problem.couplings[k].J * problem.couplings[k].J.transpose();
    }
    normal_step_[i] = 1.0 / A(0, 0);
    const double bound = std::max(A(1, 1), A(2, 2)) + std::abs(A(1, 2));
    tangential_step_[i] = problem.friction[i] > 0.0 ? 1.0 / bound : 0.0;
  }
}

void GaussSeidelSolver::sweep_contacts(const ConeProblem& problem, ConeSolution& solution) const {
  for (std::size_t i = 0; i < problem.size(); ++i) {
    const double mu = problem.friction[i];
    const Vec3 p = solution.p[i];
    const Vec3 c = problem.velocity(i, solution.y);
    const double normal = std::max(0.0, p.x() - normal_step_[i] * c.x());
    if (normal == 0.0 && p.isZero(0.0) && std::isfinite(mu)) continue;
    Vec3 next(normal, 0.0, 0.0);
    if (mu > 0.0) {
      // The tangents see the new normal impulse.
      Vec3 pushed = c;
      for (std::uint32_t k = problem.first[i]; k < problem.first[i + 1]; ++k) {
        const Jacobian& J = problem.couplings[k].J;
        pushed.tail<2>().noalias() += (normal - p.x()) * (J.bottomRows<2>() * J.row(0).transpose());
      }
      const Vec2 trial = p.tail<2>() - tangential_step_[i] * pushed.tail<2>();
      next = project_on_friction({normal, trial.x(), trial.y()}, mu);
    }
    problem.add_impulse(i, next - p, solution.y);
    solution.p[i] = next;
  }
}

void GaussSeidelSolver::sweep_until(const ConeProblem& problem, double limit, int last,
                                    ConeSolution& solution) const {
  constexpr int sweeps_per_check = 5;
  solution.y = velocities_of(problem, solution.p);
  while (solution.iterations < last) {
    for (int k = 0; k < sweeps_per_check && solution.iterations < last; ++k) {
      sweep_contacts(problem, solution);
      ++solution.iterations;
    }
    if (natural_map_residual(problem, solution.p, solution.y) <= limit) return;
  }
}

// All patches, so that guessed and swept shares become even ones, or those that are not solved yet.
void GaussSeidelSolver::sweep_patches(const ConeProblem& problem, double limit, bool all,
                                      ConeSolution& solution) {
  for (Patch& patch : patches_) {
    if (all || residual(problem, patch, solution) > 0.1 * limit) {
      update(problem, patch, 0.1 * limit, solution);
    }
  }
}

void GaussSeidelSolver::cut(const ConeProblem& problem) {
  patches_.resize(problem.patch.empty() ? 0 : problem.patch.size() - 1);
  for (std::size_t k = 0; k < patches_.size(); ++k) {
    Patch& patch = patches_[k];
    patch.begin = problem.patch[k];
    patch.problem.clear();
    patch.blocks.clear();
    for (std::uint32_t i = problem.patch[k]; i < problem.patch[k + 1]; ++i) {
      for (std::uint32_t c = problem.first[i]; c < problem.first[i + 1]; ++c) {
        Coupling coupling = problem.couplings[c];
        const auto at = std::find(patch.blocks.begin(), patch.blocks.end(), coupling.block);
        const auto local = static_cast<std::uint32_t>(at - patch.blocks.begin());
        if (at == patch.blocks.end()) patch.blocks.push_back(coupling.block);
        coupling.block = local;
        patch.problem.couplings.push_back(coupling);
      }
      patch.problem.first.push_back(static_cast<std::uint32_t>(patch.problem.couplings.size()));
      patch.problem.bias.push_back(problem.bias[i]);
      patch.problem.friction.push_back(problem.friction[i]);
      patch.problem.compliance.push_back(problem.compliance[i]);
    }
    patch.problem.blocks = patch.blocks.size();
    patch.problem.y_free.resize(static_cast<Eigen::Index>(6 * patch.blocks.size()));
  }
}

double GaussSeidelSolver::residual(const ConeProblem& problem, const Patch& patch,
                                   const ConeSolution& solution) const {
  double worst = 0.0;
  for (std::size_t k = 0; k < patch.problem.size(); ++k) {
    worst = std::max(worst, natural_map_residual(problem, patch.begin + k,
                                                 solution.p[patch.begin + k], solution.y));
  }
  return worst;
}

void GaussSeidelSolver::update(const ConeProblem& problem, Patch& patch, double limit,
                               ConeSolution& solution) {
  ConeProblem& local = patch.problem;
  const std::size_t n = local.size();
  guess_.assign(solution.p.begin() + patch.begin,
                solution.p.begin() + patch.begin + static_cast<std::ptrdiff_t>(n));
  for (std::size_t b = 0; b < patch.blocks.size(); ++b) {
    local.y_free.segment<6>(static_cast<Eigen::Index>(6 * b)) =
        solution.y.segment<6>(Eigen::Index{6} * patch.blocks[b]);
  }
  for (std::size_t i = 0; i < n; ++i) local.add_impulse(i, -guess_[i], local.y_free);

  newton_.solve(local, &guess_, limit, patch.solution);
  if (!patch.solution.converged) return;  // left to the contact sweeps
  for (std::size_t i = 0; i < n; ++i) {
    problem.add_impulse(patch.begin + i, patch.solution.p[i] - guess_[i], solution.y);
    solution.p[patch.begin + i] = patch.solution.p[i];
  }
}

}  // namespace gotai::impulse
