/// @file
/// The iterative solver: sparse projected block Gauss-Seidel.
#pragma once

#include <vector>

#include "gotai/impulse/cone_problem.h"
#include "gotai/impulse/contact_sweeps.h"
#include "gotai/impulse/newton_solver.h"

namespace gotai::impulse {

/// Solves a ConeProblem by two kinds of sweeps in fixed order, in rounds:
///   contact sweeps  normal, then tangents of one contact after the other, all others at rest:
///   cheap,
///                   twice as many in every round;
///   patch sweeps    all contacts of a pair together, exactly (NewtonSolver): redundant contacts of
///                   one patch make contact sweeps crawl and leave the load where it first fell; a
///                   patch sweep shares it evenly by the same compliance as the exact solver.
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
  void sweep_unsolved(const ConeProblem& problem, int sweeps, double limit, ConeSolution& solution);
  void solve_parts(const ConeProblem& problem, double limit, ConeSolution& solution);
  void sweep_patches(const ConeProblem& problem, double limit, bool all, ConeSolution& solution);
  double residual(const ConeProblem& problem, const Patch& patch,
                  const ConeSolution& solution) const;
  void update(const ConeProblem& problem, Patch& patch, double limit, ConeSolution& solution);

  std::vector<Patch> patches_;
  ContactSweeps sweeps_;
  std::vector<Vec3> guess_;  // p of a patch or part
  std::vector<Vec3> kept_;   // p before a patch sweep
  NewtonSolver newton_;
};

}  // namespace gotai::impulse
