/// @file
/// The contact problem of one island of touching bodies, its solution, and how wrong a solution
/// is. Knows nothing of worlds: solvers are tested on it alone.
///
/// Unknowns are impulses p_i in contact frames (normal, two tangents) [N s] and mass-scaled
/// velocities y [sqrt(kg) m/s], six per body ("block"), so that the kinetic energy is y'y/2:
///   y   = y_free + J' p,                          A = J J'   (Makino 2007, eqs. 4.14, 4.15)
///   c_i = J_i y + bias_i,                         relative velocity plus target [m/s]
///   0 <= p_N  _|_  c_N >= 0,                      (4.16) in the reading of errata 3 and 4
///   |p_T| <= mu p_N,  c_T opposite to p_T when |p_T| = mu p_N, else c_T = 0       (Coulomb)
/// p is not unique when contacts are redundant. Among the solutions the tiny compliance R_i
/// chooses: the limit of contacts that yield by R_i p_i, which share the load evenly (erratum 23).
#pragma once

#include <limits>
#include <vector>

#include "gotai/core/types.h"

namespace gotai::impulse {

using Jacobian = Eigen::Matrix<double, 3, 6>;

/// How one contact moves with one block of unknowns.
struct Coupling {
  std::uint32_t block = 0;
  Jacobian J;  ///< rows: normal, tangent 1, tangent 2; mass-scaled [1/sqrt(kg)]
};

/// One island, structure of arrays over its contacts.
struct ConeProblem {
  /// Friction of a contact whose tangential impulse is not limited at all (SEM).
  static constexpr double unlimited = std::numeric_limits<double>::infinity();

  std::size_t blocks = 0;            ///< bodies, six unknowns each
  Eigen::VectorXd y_free;            ///< mass-scaled velocities without contact impulses
  std::vector<std::uint32_t> first;  ///< couplings of contact i: [first[i], first[i + 1])
  std::vector<Coupling> couplings;   ///< of one contact: different blocks
  std::vector<Vec3> bias;            ///< added to J y [m/s]
  std::vector<double> friction;      ///< mu >= 0 or unlimited
  std::vector<double> compliance;    ///< R > 0 [1/kg]
  std::vector<std::uint32_t> patch;  ///< patches (pairs) as contact ranges: [patch[k], patch[k+1])

  std::size_t size() const { return bias.size(); }
  /// Empties it, but y_free, which is sized with the blocks; storage is kept.
  void clear();
  /// c_i = J_i y + bias_i [m/s].
  Vec3 velocity(std::size_t i, const Eigen::VectorXd& y) const;
  /// y += J_i' p.
  void add_impulse(std::size_t i, const Vec3& p, Eigen::VectorXd& y) const;
  /// Mean of the diagonal of the contact's own block of A [1/kg].
  double inertness(std::size_t i) const;
};

inline Vec3 ConeProblem::velocity(std::size_t i, const Eigen::VectorXd& y) const {
  Vec3 c = bias[i];
  for (std::uint32_t k = first[i]; k < first[i + 1]; ++k) {
    c.noalias() += couplings[k].J * y.segment<6>(Eigen::Index{6} * couplings[k].block);
  }
  return c;
}

inline void ConeProblem::add_impulse(std::size_t i, const Vec3& p, Eigen::VectorXd& y) const {
  for (std::uint32_t k = first[i]; k < first[i + 1]; ++k) {
    y.segment<6>(Eigen::Index{6} * couplings[k].block).noalias() += couplings[k].J.transpose() * p;
  }
}

/// Sets R_i = ridge * trace(A_N)/n * (mean area / area_i) with A_N the normal rows (errata 4, 23).
/// @param area  surface that each contact stands for [m^2], > 0
void set_compliance(ConeProblem& problem, const std::vector<double>& area, double ridge);

/// Impulses of an island and what it took to find them.
struct ConeSolution {
  std::vector<Vec3> p;    ///< contact frames [N s]
  Eigen::VectorXd y;      ///< y_free + J' p
  double residual = 0.0;  ///< natural_map_residual() [m/s]
  int iterations = 0;
  bool converged = false;
};

/// Projection of z on what a contact can do: normal part >= 0, tangential part within mu times it.
Vec3 project_on_friction(const Vec3& z, double friction);

/// Largest |p - P(p - rho c)| / rho over the contacts, rho = 1/inertness: a velocity [m/s], zero
/// exactly at a solution of the rigid problem (R = 0). y must be y_free + J' p.
double natural_map_residual(const ConeProblem& problem, const std::vector<Vec3>& p,
                            const Eigen::VectorXd& y);
/// The same of one contact.
double natural_map_residual(const ConeProblem& problem, std::size_t i, const Vec3& p,
                            const Eigen::VectorXd& y);
/// y_free + J' p.
Eigen::VectorXd velocities_of(const ConeProblem& problem, const std::vector<Vec3>& p);
/// Largest |c_i| without impulses: the scale of residuals [m/s].
double velocity_scale(const ConeProblem& problem);

}  // namespace gotai::impulse
