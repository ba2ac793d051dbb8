/// @file
/// The solver of small frictionless problems: one row per contact.
#pragma once

#include "gotai/impulse/cone_problem.h"

namespace gotai::impulse {

/// Solves the normal rows of a problem without friction by projected Gauss-Seidel, row by row: for
/// few rows that are hardly redundant, such as apparent contacts, where a Newton step would cost
/// more than all sweeps.
/// @param limit       residual to reach [m/s]
/// @param max_sweeps  gives up after so many; solution.converged tells
void solve_rows(const ConeProblem& problem, double limit, int max_sweeps, ConeSolution& solution);

}  // namespace gotai::impulse
