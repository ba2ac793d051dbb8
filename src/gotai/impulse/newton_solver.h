/// @file
/// The exact solver: semismooth Newton in velocities.
#pragma once

#include <vector>

#include "gotai/impulse/cone_problem.h"
#include "gotai/impulse/newton_system.h"

namespace gotai::impulse {

/// Solves a ConeProblem to rounding error.
///
/// With the compliance R a contact's impulse is a function of its velocity, p = P(-c / R) with P
/// the projection on the friction law, so that y - y_free - J' p(y) = 0 remains: 6 x blocks
/// equations, whatever the number of contacts. Without friction this is the minimisation
///   min 1/2 |y - y_free|^2 + sum_i 1/(2 R_i) min(0, c_i)^2,
/// the dual of the non-negative least squares min 1/2 p'(A + R)p + q'p, p >= 0 (erratum 22).
/// Two stages:
///   approach  follows the solution from a large compliance down to the stated one by factors of
///             ten, each by damped Newton steps (skipped when a good guess is at hand);
///   polish    Newton on y and p together (an active-set method: open, stick, slide per contact),
///             which is free of the cancellation in c / R. A second pass measures the compliance
///             from the impulses found (a proximal step): they keep their even shares while the
///             velocities become those of rigid contact, c = 0 instead of c = -R p.
class NewtonSolver {
 public:
  /// @param guess  impulses to start from (not solution.p itself), or nothing
  /// @param limit  residual to reach [m/s]
  void solve(const ConeProblem& problem, const std::vector<Vec3>* guess, double limit,
             ConeSolution& solution);
  /// Only the polishing from a guess that is nearly right; where many redundant contacts keep it
  /// from converging, proximal steps: polishing with a compliance that is at rest at the last
  /// impulses, so that its size does not matter for the result. Never ends worse than the guess.
  void refine(const ConeProblem& problem, const std::vector<Vec3>& guess, double limit,
              ConeSolution& solution);

 private:
  void start(const ConeProblem& problem, ConeSolution& solution);
  void approach(const ConeProblem& problem, ConeSolution& solution);
  bool polish_twice(const ConeProblem& problem, double limit, int max_iterations,
                    ConeSolution& solution);
  bool polish(const ConeProblem& problem, double limit, int least_iterations, int max_iterations,
              ConeSolution& solution);
  void polish_proximally(const ConeProblem& problem, double limit, ConeSolution& solution);
  double evaluate(const ConeProblem& problem, double softness, const Eigen::VectorXd& y);

  NewtonSystem system_;
  std::vector<double> inertness_;  // per contact
  std::vector<Mat3> D_;            // per contact, of the Newton matrix
  std::vector<Vec3> p_;            // impulses at a trial point, or their change
  std::vector<Vec3> defect_;       // P(z) - p
  std::vector<Vec3> reference_;    // impulses at which the compliance is at rest
  double softness_ = 1.0;          // of polish(), times the stated compliance
  Eigen::VectorXd F_, step_, trial_;
};

}  // namespace gotai::impulse
