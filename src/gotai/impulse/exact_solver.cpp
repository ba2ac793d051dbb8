#include "gotai/impulse/exact_solver.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "gotai/impulse/interior_point_solver.h"
#include "gotai/impulse/newton_solver.h"

namespace gotai::impulse {

namespace {

// Newton alone finds its way on small problems and on those without friction.
constexpr std::size_t newton_up_to_bodies = 8;
bool has_friction(const ConeProblem& problem) {
  return std::any_of(problem.friction.begin(), problem.friction.end(),
                     [](double mu) { return mu > 0.0; });
}

}  // namespace

void solve_exact(const ConeProblem& problem, const std::vector<Vec3>* guess, double limit,
                 ConeSolution& solution) {
  NewtonSolver newton;
  const bool path = InteriorPointSolver::suits(problem) && has_friction(problem);
  solution.residual = std::numeric_limits<double>::infinity();
  solution.iterations = 0;
  if (!path || problem.blocks <= newton_up_to_bodies) {
    newton.solve(problem, guess, limit, solution);
    if (solution.converged || !path) return;
  }

  ConeSolution start;
  InteriorPointSolver().solve(problem, limit, start);
  ConeSolution refined;
  newton.refine(problem, start.p, limit, refined);
  refined.iterations += solution.iterations + start.iterations;
  if (refined.residual < solution.residual) {
    solution = std::move(refined);
  } else {
    solution.iterations = refined.iterations;
  }
}

}  // namespace gotai::impulse
