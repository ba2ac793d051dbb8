#include "gotai/impulse/gauss_seidel_solver.h"

#include <algorithm>

namespace gotai::impulse {

void GaussSeidelSolver::solve(const ConeProblem& problem, const std::vector<Vec3>* guess,
                              double limit, int max_sweeps, ConeSolution& solution) {
  if (guess != nullptr) {
    solution.p = *guess;
  } else {
    solution.p.assign(problem.size(), Vec3::Zero());
  }
  cut(problem);
  for (solution.iterations = 0;; ++solution.iterations) {
    solution.y = velocities_of(problem, solution.p);  // no drift from the updates below
    solution.residual = natural_map_residual(problem, solution.p, solution.y);
    solution.converged = solution.residual <= limit && solution.iterations > 0;
    if (solution.converged || solution.iterations >= max_sweeps) return;
    // The first sweep takes every patch, so that the shares of a guess become even ones.
    for (Patch& patch : patches_) {
      if (solution.iterations == 0 || residual(problem, patch, solution) > 0.1 * limit) {
        update(problem, patch, 0.1 * limit, solution);
      }
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
        solution.y.segment<6>(6 * patch.blocks[b]);
  }
  for (std::size_t i = 0; i < n; ++i) local.add_impulse(i, -guess_[i], local.y_free);

  newton_.solve(local, &guess_, limit, patch.solution);
  for (std::size_t i = 0; i < n; ++i) {
    problem.add_impulse(patch.begin + i, patch.solution.p[i] - guess_[i], solution.y);
    solution.p[patch.begin + i] = patch.solution.p[i];
  }
}

void solve_exact(const ConeProblem& problem, const std::vector<Vec3>* guess, double limit,
                 ConeSolution& solution) {
  constexpr int rounds = 8;
  constexpr int sweeps_per_round = 50;
  NewtonSolver newton;
  newton.solve(problem, guess, limit, solution);
  if (solution.converged) return;

  int iterations = solution.iterations;
  GaussSeidelSolver gauss_seidel;
  std::vector<Vec3> start(problem.size(), Vec3::Zero());
  for (int round = 0; round < rounds; ++round) {
    gauss_seidel.solve(problem, &start, limit, sweeps_per_round, solution);
    iterations += solution.iterations;
    start = solution.p;
    if (solution.converged) break;
    ConeSolution refined;
    newton.refine(problem, start, limit, refined);
    iterations += refined.iterations;
    if (refined.residual < solution.residual) solution = refined;
    if (solution.converged) break;
  }
  solution.iterations = iterations;
}

}  // namespace gotai::impulse
