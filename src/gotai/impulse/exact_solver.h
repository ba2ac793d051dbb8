/// @file
/// The exact solver of contact problems.
#pragma once

#include <vector>

#include "gotai/impulse/cone_problem.h"

namespace gotai::impulse {

/// Solves a problem to rounding error where its solution allows it. Newton in velocities first
/// (NewtonSolver); where friction keeps it from converging, and on frictional islands of more than
/// a few bodies at once, the interior point method (InteriorPointSolver), whose result Newton then
/// polishes; where that fails too, the same once more from the solution with half the friction. The
/// result with the smallest residual is kept; solution.residual says how exact it is.
/// @param guess  impulses to start from, or nothing
/// @param limit  residual to reach [m/s]
void solve_exact(const ConeProblem& problem, const std::vector<Vec3>* guess, double limit,
                 ConeSolution& solution);

}  // namespace gotai::impulse
