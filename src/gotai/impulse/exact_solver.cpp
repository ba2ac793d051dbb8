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
constexpr double worth_refining = 1e-3;  // residual after the path / velocity scale
constexpr double good_enough = 1e-7;     // of the end result

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

  InteriorPointSolver interior_point;
  const double scale = velocity_scale(problem);
  const auto follow = [&](const ConeSolution* near) {
    ConeSolution end;
    interior_point.solve(problem, near, limit, end);
    int iterations = solution.iterations + end.iterations;
    if (end.residual <= worth_refining * scale) {
      ConeSolution refined;
      newton.refine(problem, end.p, limit, refined);
      iterations += refined.iterations;
      end = std::move(refined);
    }
    if (end.residual < solution.residual) solution = std::move(end);
    solution.iterations = iterations;
    return solution.residual <= good_enough * scale;
  };
  if (follow(nullptr)) return;

  // Half the friction is far easier, and its solution often near to the one sought.
  ConeProblem half = problem;
  for (double& mu : half.friction) mu *= 0.5;
  ConeSolution near;
  interior_point.solve(half, nullptr, limit, near);
  solution.iterations += near.iterations;
  follow(&near);
}

}  // namespace gotai::impulse
