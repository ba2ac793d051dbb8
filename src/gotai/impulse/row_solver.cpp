#include "gotai/impulse/row_solver.h"

#include <algorithm>
#include <cmath>

namespace gotai::impulse {

void solve_rows(const ConeProblem& problem, double limit, int max_sweeps, ConeSolution& solution) {
  const std::size_t n = problem.size();
  solution.p.assign(n, Vec3::Zero());
  solution.y = problem.y_free;
  solution.converged = false;
  for (solution.iterations = 0; !solution.converged && solution.iterations < max_sweeps;
       ++solution.iterations) {
    // A sweep's largest change bounds what is left only roughly, so the residual decides.
    double largest_change = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      double velocity = problem.bias[i].x();
      double inertness = 0.0;
      for (std::uint32_t k = problem.first[i]; k < problem.first[i + 1]; ++k) {
        const auto row = problem.couplings[k].J.row(0);
        velocity += row.dot(solution.y.segment<6>(Eigen::Index{6} * problem.couplings[k].block));
        inertness += row.squaredNorm();
      }
      const double p = std::max(0.0, solution.p[i].x() - velocity / inertness);
      const double change = p - solution.p[i].x();
      if (change == 0.0) continue;
      largest_change = std::max(largest_change, std::abs(change) * inertness);
      solution.p[i].x() = p;
      for (std::uint32_t k = problem.first[i]; k < problem.first[i + 1]; ++k) {
        solution.y.segment<6>(Eigen::Index{6} * problem.couplings[k].block) +=
            change * problem.couplings[k].J.row(0).transpose();
      }
    }
    if (n > 1 && largest_change > 10.0 * limit) continue;
    solution.residual = natural_map_residual(problem, solution.p, solution.y);
    solution.converged = solution.residual <= limit;
  }
}

}  // namespace gotai::impulse
