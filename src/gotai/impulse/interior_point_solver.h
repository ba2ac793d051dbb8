/// @file
/// Interior point method for contact problems with Coulomb friction.
#pragma once

#include <vector>

#include "gotai/impulse/cone_problem.h"
#include "gotai/impulse/newton_system.h"

namespace gotai::impulse {

/// Solves a ConeProblem from nothing, however many of its contacts are redundant.
///
/// With De Saxce's change of variables, u~_N = c_N + mu |c_T|, Coulomb's law is complementarity of
/// two self-dual cones, scaled to  L = {|x_T| <= x_N}  by  z = (p_N, p_T / mu),  s = (u~_N, mu
/// c_T):
///   z in L,  s in L,  z . s = 0.
/// A primal-dual path with Nesterov-Todd scaling and Mehrotra's predictor and corrector leads to it
/// [Acary, Armand, Nguyen, Shpakovych 2023, "Second-order cone programming for frictional contact
/// mechanics using interior point algorithm"]. The derivative of mu |c_T| is part of every step:
/// without it the path is followed at first order only. A step is one linear system in the 6 x
/// blocks velocities.
///
/// Ends within about 1e-7 of the velocity scale, which NewtonSolver::refine() takes to rounding
/// error. The problem is not monotone: nothing guarantees that the path reaches a solution; the
/// residual says.
class InteriorPointSolver {
 public:
  /// Every contact has a finite friction.
  static bool suits(const ConeProblem& problem);

  /// @param near   a point to start near, such as the solution of a problem like this, or nothing
  /// @param limit  residual to reach [m/s]
  void solve(const ConeProblem& problem, const ConeSolution* near, double limit,
             ConeSolution& solution);

 private:
  /// One contact; L-scaled.
  struct Contact {
    Vec3 scale;         // T: p = T z, s = T u~
    Vec3 s, z;          // slack [m/s], impulse [N s]
    Vec3 ds, dz;        // their step
    Vec3 defect;        // s - s(y)
    Vec3 slip;          // (0, direction of c_T)
    Mat3 W, W_inverse;  // W z = W_inverse s = lambda
    Vec3 lambda;
    Mat3 K;  // dz = rest - K G dy
    Vec3 rest;
  };

  void start(const ConeProblem& problem);
  void start_near(const ConeProblem& problem, double distance, const ConeSolution& point);
  double measure(const ConeProblem& problem);
  void scale_contacts();
  bool factorise(const ConeProblem& problem);
  bool step_to(const ConeProblem& problem, double target, bool correct);
  double longest_step() const;
  void keep_best(const ConeProblem& problem, int iteration, ConeSolution& solution);

  NewtonSystem system_;
  std::vector<Contact> contacts_;
  std::vector<Mat3> D_;
  std::vector<Vec3> p_;
  Eigen::VectorXd y_, dual_defect_, dy_;
  int best_iteration_ = 0;
};

}  // namespace gotai::impulse
