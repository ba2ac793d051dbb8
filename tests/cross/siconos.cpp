// Our solvers against Siconos (an independent code for non-smooth dynamics) on the same problems.
#include <gtest/gtest.h>

#include "gotai/impulse/exact_solver.h"
#include "gotai/impulse/gauss_seidel_solver.h"
#include "support/contact_problems.h"

#ifdef GOTAI_HAS_SICONOS
extern "C" {
#include <FrictionContactProblem.h>
#include <Friction_cst.h>
#include <LinearComplementarityProblem.h>
#include <NonSmoothDrivers.h>
#include <NumericsMatrix.h>
#include <SolverOptions.h>
#include <lcp_cst.h>
}
#endif

namespace gotai::impulse {
namespace {

#ifdef GOTAI_HAS_SICONOS

// Velocities after Siconos's impulses.
Eigen::VectorXd velocities_after(const ConeProblem& problem, const Eigen::VectorXd& p) {
  std::vector<Vec3> impulses(problem.size());
  for (std::size_t i = 0; i < impulses.size(); ++i) {
    impulses[i] = p.segment<3>(static_cast<Eigen::Index>(3 * i));
  }
  return velocities_of(problem, impulses);
}

// Frictionless impulses by Lemke's pivoting; empty when it fails.
Eigen::VectorXd lemke(const ConeProblem& problem) {
  const Eigen::MatrixXd A = test::delassus(problem);
  const Eigen::VectorXd q = test::free_velocities(problem);
  const auto n = static_cast<Eigen::Index>(problem.size());
  Eigen::MatrixXd M(n, n);
  Eigen::VectorXd q_n(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    q_n[i] = q[3 * i];
    for (Eigen::Index j = 0; j < n; ++j) M(i, j) = A(3 * i, 3 * j);
    // Pivoting needs a regular matrix; our own compliance would move velocities by R p, 1e-8.
    M(i, i) += 1e-3 * problem.compliance[static_cast<std::size_t>(i)];
  }
  LinearComplementarityProblem lcp;
  lcp.size = static_cast<int>(n);
  lcp.M = NM_create_from_data(NM_DENSE, lcp.size, lcp.size, M.data());
  lcp.q = q_n.data();
  SolverOptions* options = solver_options_create(SICONOS_LCP_LEMKE);
  options->iparam[SICONOS_IPARAM_MAX_ITER] = 10000;
  options->dparam[SICONOS_DPARAM_TOL] = 1e-12;
  Eigen::VectorXd z = Eigen::VectorXd::Zero(n);
  Eigen::VectorXd w = Eigen::VectorXd::Zero(n);
  const int info = linearComplementarity_driver(&lcp, z.data(), w.data(), options);
  solver_options_delete(options);
  if (info != 0) return {};
  Eigen::VectorXd p = Eigen::VectorXd::Zero(3 * n);
  for (Eigen::Index i = 0; i < n; ++i) p[3 * i] = z[i];
  return p;
}

// Impulses with Coulomb friction by non-smooth Gauss-Seidel; empty when it does not converge.
Eigen::VectorXd nsgs(const ConeProblem& problem) {
  Eigen::MatrixXd M = test::delassus(problem);
  Eigen::VectorXd q = test::free_velocities(problem);
  std::vector<double> mu = problem.friction;
  for (std::size_t i = 0; i < problem.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const auto at = static_cast<Eigen::Index>(3 * i) + k;
      M(at, at) += problem.compliance[i];
    }
  }
  FrictionContactProblem friction;
  friction.dimension = 3;
  friction.numberOfContacts = static_cast<int>(problem.size());
  friction.M = NM_create_from_data(NM_DENSE, static_cast<int>(M.rows()), static_cast<int>(M.cols()),
                                   M.data());
  friction.q = q.data();
  friction.mu = mu.data();
  SolverOptions* options = solver_options_create(SICONOS_FRICTION_3D_NSGS);
  options->iparam[SICONOS_IPARAM_MAX_ITER] = 100000;
  options->dparam[SICONOS_DPARAM_TOL] = 1e-12;
  Eigen::VectorXd p = Eigen::VectorXd::Zero(q.size());
  Eigen::VectorXd u = Eigen::VectorXd::Zero(q.size());
  const int info = fc3d_driver(&friction, p.data(), u.data(), options);
  solver_options_delete(options);
  return info == 0 ? p : Eigen::VectorXd{};
}

TEST(Siconos, FrictionlessVelocitiesAgreeOn200RandomIslands) {
  Random random(11);
  int compared = 0;
  double worst = 0.0;
  for (int trial = 0; trial < 200; ++trial) {
    const std::size_t bodies = 1 + static_cast<std::size_t>(trial) % 10;
    const ConeProblem problem = test::random_island(random, bodies, 60, 0.0, 1e-9);
    ASSERT_LE(problem.size(), 60U);
    ConeSolution exact;
    ConeSolution iterative;
    solve_exact(problem, nullptr, 1e-12, exact);
    GaussSeidelSolver().solve(problem, nullptr, 1e-12, 20000, iterative);
    EXPECT_LE((exact.y - iterative.y).lpNorm<Eigen::Infinity>(), 1e-8) << trial;
    const Eigen::VectorXd p = lemke(problem);
    if (p.size() == 0) continue;
    ++compared;
    const double difference = (exact.y - velocities_after(problem, p)).lpNorm<Eigen::Infinity>();
    worst = std::max(worst, difference);
    EXPECT_LE(difference, 1e-8) << trial;
  }
  EXPECT_GE(compared, 190) << "Lemke failed too often for a comparison";
  RecordProperty("compared", compared);
  RecordProperty("worst_velocity_difference", std::to_string(worst));
}

TEST(Siconos, FrictionalVelocitiesAgreeOnFullRankProblems) {
  Random random(12);
  int compared = 0;
  for (int trial = 0; trial < 100; ++trial) {
    // At most two contacts per body: 6 rows for 6 unknowns.
    const std::size_t bodies = 2 + static_cast<std::size_t>(trial) % 6;
    const double mu = trial % 2 == 0 ? 0.1 : 0.3;
    const ConeProblem problem = test::random_island(random, bodies, 2 * bodies, mu, 1e-9);
    ConeSolution exact;
    solve_exact(problem, nullptr, 1e-12, exact);
    EXPECT_LE(exact.residual, 1e-8) << trial;
    ConeSolution iterative;
    GaussSeidelSolver().solve(problem, nullptr, 1e-11, 20000, iterative);
    EXPECT_LE(iterative.residual, 1e-8) << trial;
    EXPECT_LE((exact.y - iterative.y).lpNorm<Eigen::Infinity>(), 1e-6) << trial << " mu " << mu;
    const Eigen::VectorXd p = nsgs(problem);
    if (p.size() == 0) continue;
    ++compared;
    EXPECT_LE((exact.y - velocities_after(problem, p)).lpNorm<Eigen::Infinity>(), 1e-6)
        << trial << " mu " << mu;
  }
  EXPECT_GE(compared, 90) << "NSGS failed too often for a comparison";
  RecordProperty("compared", compared);
}

#else

TEST(Siconos, Compares) {
  GTEST_SKIP() << "Siconos was not found when the build was configured "
                  "(apt-get install libsiconos-numerics-dev)";
}

#endif

}  // namespace
}  // namespace gotai::impulse
