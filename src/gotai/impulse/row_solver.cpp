#include "gotai/impulse/row_solver.h"

#include <algorithm>
#include <cmath>

namespace gotai::impulse {
namespace {

// Velocity of a row, with its bias [m/s].
double row_velocity(const ConeProblem& problem, std::size_t i, const Eigen::VectorXd& y) {
  double velocity = problem.bias[i].x();
  for (std::uint32_t k = problem.first[i]; k < problem.first[i + 1]; ++k) {
    const Coupling& coupling = problem.couplings[k];
    velocity += coupling.J.row(0).dot(y.segment<6>(Eigen::Index{6} * coupling.block));
  }
  return velocity;
}

}  // namespace

void RowSolver::solve(const ConeProblem& problem, double limit, int max_sweeps,
                      ConeSolution& solution) {
  const std::size_t n = problem.size();
  solution.p.assign(n, Vec3::Zero());
  solution.y = problem.y_free;
  solution.converged = false;
  inertness_.resize(n);
  for (std::size_t i = 0; i < n; ++i) inertness_[i] = problem.inertness(i);

  for (solution.iterations = 0; !solution.converged && solution.iterations < max_sweeps;
       ++solution.iterations) {
    // A sweep's largest change bounds what is left only roughly, so the residual decides.
    double largest_change = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      double& p = solution.p[i].x();
      const double last = p;
      p = std::max(0.0, p - row_velocity(problem, i, solution.y) / inertness_[i]);
      const double change = p - last;
      if (change == 0.0) continue;
      largest_change = std::max(largest_change, std::abs(change) * inertness_[i]);
      for (std::uint32_t k = problem.first[i]; k < problem.first[i + 1]; ++k) {
        const Coupling& coupling = problem.couplings[k];
        solution.y.segment<6>(Eigen::Index{6} * coupling.block) +=
            change * coupling.J.row(0).transpose();
      }
    }
    if (n > 1 && largest_change > 10.0 * limit) continue;
    // |p - max(0, p - v / inertness)| * inertness: natural_map_residual() of a row.
    solution.residual = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      const double step =
          std::min(row_velocity(problem, i, solution.y), solution.p[i].x() * inertness_[i]);
      solution.residual = std::max(solution.residual, std::abs(step));
    }
    solution.converged = solution.residual <= limit;
  }
}

}  // namespace gotai::impulse
