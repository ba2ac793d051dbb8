/// @file
/// The iterative solver: sparse projected block Gauss-Seidel.
#pragma once

#include <vector>

#include "gotai/impulse/cone_problem.h"
#include "gotai/impulse/contact_sweeps.h"
#include "gotai/impulse/newton_solver.h"

namespace gotai::impulse {

/// Solves a ConeProblem in rounds of three kinds of work, in fixed order, each as long as it pays:
///   contact sweeps  accelerated, one contact after the other (ContactSweeps): cheap. After the
///                   first sweeps only the parts of the island that are not solved yet;
///   patch sweeps    all contacts of a pair together, exactly (NewtonSolver): redundant contacts of
///                   one patch make contact sweeps crawl and leave the load where it first fell;
///                   the first patch sweep shares it evenly by the same compliance as the exact
///                   solver;
///   exact parts     where both get stuck, the bodies of a small unsolved part together
///                   (solve_exact), pushed by the contacts outside as they are.
class GaussSeidelSolver {
 public:
  /// @param guess       impulses to start from, or nothing
  /// @param limit       residual to reach [m/s]
  /// @param max_sweeps  gives up after so many: sweeps over all contacts, or as many contacts in
  ///                    parts, and over all patches; solution.converged tells
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
