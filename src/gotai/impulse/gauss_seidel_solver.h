/// @file
/// The iterative solver: sparse projected block Gauss-Seidel.
#pragma once

#include <vector>

#include "gotai/impulse/cone_problem.h"
#include "gotai/impulse/newton_solver.h"

namespace gotai::impulse {

/// Solves a ConeProblem patch by patch: the impulses of one pair of bodies exactly (NewtonSolver,
/// with friction and the same compliance, so that the load is shared evenly within the pair) while
/// all others stand still, over and over in a fixed order. A block is a whole patch because
/// redundant contacts of one patch, taken one by one, would make the sweeps crawl and would leave
/// the load where they first put it.
class GaussSeidelSolver {
 public:
  /// @param guess       impulses to start from, or nothing
  /// @param limit       residual to reach [m/s]
  /// @param max_sweeps  gives up after so many; solution.converged tells
  void solve(const ConeProblem& problem, const std::vector<Vec3>* guess, double limit,
             int max_sweeps, ConeSolution& solution);

 private:
  /// One patch as a problem of its own, and which blocks of the island it moves.
  struct Patch {
    ConeProblem problem;
    std::uint32_t begin = 0;            // first contact in the island
    std::vector<std::uint32_t> blocks;  // of the island
    ConeSolution solution;
  };

  void cut(const ConeProblem& problem);
  double residual(const ConeProblem& problem, const Patch& patch,
                  const ConeSolution& solution) const;
  void update(const ConeProblem& problem, Patch& patch, double limit, ConeSolution& solution);

  std::vector<Patch> patches_;
  std::vector<Vec3> guess_;
  NewtonSolver newton_;
};

/// The exact solver for any island: Newton, and where friction keeps it from converging a few
/// sweeps of Gauss-Seidel to start anew from.
/// @param guess  impulses to start from, or nothing
/// @param limit  residual to reach [m/s]
void solve_exact(const ConeProblem& problem, const std::vector<Vec3>* guess, double limit,
                 ConeSolution& solution);

}  // namespace gotai::impulse
