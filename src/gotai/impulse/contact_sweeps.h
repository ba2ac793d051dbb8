/// @file
/// Accelerated projected Gauss-Seidel over single contacts, on all of an island or parts of it.
#pragma once

#include <vector>

#include "gotai/impulse/cone_problem.h"

namespace gotai::impulse {

/// Contacts of an island that are swept together, ascending, and all blocks that they move.
struct ContactSubset {
  std::vector<std::uint32_t> contacts;
  std::vector<std::uint32_t> blocks;
};

/// Sweeps over contacts, one after the other: first the normal impulse, then the tangents, all
/// other contacts at rest. Between sweeps all impulses of the subset move on in the direction in
/// which they changed, with Nesterov's momentum [Nesterov 1983; Mazhar et al. 2015 for contacts],
/// which starts anew when it points the wrong way [O'Donoghue & Candes 2015] or the changes grow.
/// Far fewer sweeps reach a tolerance than without it: a tenth on piles (docs/methods.md).
class ContactSweeps {
 public:
  /// Step sizes of a problem; no work is counted yet.
  void prepare(const ConeProblem& problem);

  /// Sweeps until the subset's residual is at most `limit` [m/s], or `sweeps` are done.
  /// @param[in,out] solution  p and y = y_free + J' p
  void run(const ConeProblem& problem, const ContactSubset& subset, int sweeps, double limit,
           ConeSolution& solution);

  /// Contacts visited since prepare(), as sweeps over all contacts, rounded up.
  int sweeps_done() const;

 private:
  void sweep(const ConeProblem& problem, const ContactSubset& subset, ConeSolution& solution);
  void extrapolate(const ContactSubset& subset, double momentum, ConeSolution& solution);

  std::vector<double> normal_step_;      // per contact: 1 / A_NN [kg]
  std::vector<double> tangential_step_;  // per contact: 1 / (bound of the eigenvalues of A_TT) [kg]
  std::vector<double> inertness_;        // per contact [1/kg]
  std::vector<Vec3> before_;             // p before the sweep
  std::vector<Vec3> last_;               // p after the sweep before
  Eigen::VectorXd last_y_;               // y that belongs to last_
  std::size_t visits_ = 0;
};

/// The whole island.
ContactSubset all_contacts(const ConeProblem& problem);

/// What is not solved yet: the bodies of contacts whose residual exceeds `limit` [m/s] and those
/// they touch, in connected groups, with the contacts between them. In order of their contacts.
std::vector<ContactSubset> unsolved_parts(const ConeProblem& problem, const ConeSolution& solution,
                                          double limit);

}  // namespace gotai::impulse
