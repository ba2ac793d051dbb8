/// @file
/// The solver of small frictionless problems: one row per contact.
#pragma once

#include <vector>

#include "gotai/impulse/cone_problem.h"

namespace gotai::impulse {

/// Solves the normal rows of a problem without friction by projected Gauss-Seidel, row by row: for
/// few rows that are hardly redundant, such as apparent contacts, where a Newton step would cost
/// more than all sweeps. Keeps storage from solve to solve.
class RowSolver {
 public:
  /// @param limit       residual to reach [m/s]
  /// @param max_sweeps  gives up after so many; solution.converged tells
  void solve(const ConeProblem& problem, double limit, int max_sweeps, ConeSolution& solution);

 private:
  std::vector<double> inertness_;  // per row [1/kg]
};

}  // namespace gotai::impulse
