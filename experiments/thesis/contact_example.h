/// @file
/// A body of mass 1 kg in the plane that touches at a few points below it: the worked examples of
/// chapters 2 and 5.
#pragma once

#include <vector>

namespace gotai::experiments {

/// The centre of mass is at height 1 (I = 1 kg m^2, so that two contacts at arms -1 and 1 do not
/// feel each other), normals point up.
struct ContactExample {
  std::vector<double> arm;   ///< x of each contact from the centre of mass [m]
  std::vector<double> v;     ///< normal velocity of each contact before [m/s]
  double restitution = 0.5;  ///< e
};

/// Impulses [N s] and normal velocities [m/s] after.
struct ContactAnswer {
  std::vector<double> p;
  std::vector<double> v;
};

/// Solves (4.16) with the exact solver.
ContactAnswer solve_example(const ContactExample& example);

}  // namespace gotai::experiments
