// The solvers of contact problems against exact solutions, each other and themselves.
#include <gtest/gtest.h>

#include "gotai/impulse/exact_solver.h"
#include "gotai/impulse/gauss_seidel_solver.h"
#include "gotai/impulse/interior_point_solver.h"
#include "support/contact_problems.h"
#include "support/golden.h"

namespace gotai::impulse {
namespace {

Eigen::MatrixXd matrix(const nlohmann::json& rows) {
  const auto n = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd A(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      A(i, j) = rows[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)].get<double>();
    }
  }
  return A;
}

Eigen::VectorXd vector(const nlohmann::json& values) {
  Eigen::VectorXd v(static_cast<Eigen::Index>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i) {
    v[static_cast<Eigen::Index>(i)] = values[i].get<double>();
  }
  return v;
}

// Checks p and w = A p + q of a golden case.
void expect_solves(const nlohmann::json& golden, const ConeSolution& solution, double tolerance) {
  const Eigen::MatrixXd A = matrix(golden["A"]);
  const Eigen::VectorXd q = vector(golden["q"]);
  const Eigen::VectorXd w_expected = vector(golden["w"]);
  Eigen::VectorXd p(q.size());
  for (Eigen::Index i = 0; i < p.size(); ++i) p[i] = solution.p[static_cast<std::size_t>(i)].x();
  const Eigen::VectorXd w = A * p + q;
  EXPECT_LE((w - w_expected).lpNorm<Eigen::Infinity>(), tolerance) << "case " << golden["id"];
  EXPECT_GE(p.minCoeff(), 0.0);
  EXPECT_NEAR(p.dot(A * p), golden["energy_pTAp"].get<double>(),
              100 * tolerance * (1.0 + golden["energy_pTAp"].get<double>()));
  if (golden["p_unique"].get<bool>()) {
    const Eigen::VectorXd p_expected = vector(golden["p"]);
    EXPECT_LE((p - p_expected).lpNorm<Eigen::Infinity>(), 1e3 * tolerance * (1 + p.maxCoeff()));
  } else {
    for (const auto& range : golden["p_range"]) {
      const double value = p[range[0].get<Eigen::Index>()];
      EXPECT_GE(value, range[1].get<double>() - 1e3 * tolerance);
      if (!range[2].is_null()) {
        EXPECT_LE(value, range[2].get<double>() + 1e3 * tolerance);
      }
    }
  }
}

TEST(Solvers, ExactSolvesTheGoldenLcps) {
  const nlohmann::json file = test::golden("lcp.json");
  for (const auto& golden : file["cases"]) {
    const ConeProblem problem = test::lcp_problem(matrix(golden["A"]), vector(golden["q"]), 1e-9);
    ConeSolution solution;
    solve_exact(problem, nullptr, 1e-12, solution);
    EXPECT_TRUE(solution.converged) << golden["id"] << " residual " << solution.residual;
    expect_solves(golden, solution, 1e-9);
  }
}

TEST(Solvers, GaussSeidelSolvesTheGoldenLcps) {
  const nlohmann::json file = test::golden("lcp.json");
  for (const auto& golden : file["cases"]) {
    const ConeProblem problem = test::lcp_problem(matrix(golden["A"]), vector(golden["q"]), 1e-9);
    ConeSolution solution;
    GaussSeidelSolver().solve(problem, nullptr, 1e-8, 20000, solution);
    EXPECT_TRUE(solution.converged) << golden["id"] << " residual " << solution.residual;
    expect_solves(golden, solution, 1e-6);
  }
}

TEST(Solvers, AgreeOnRandomIslands) {
  Random random(7);
  int most_iterations = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const double mu = std::vector<double>{0.0, 0.1, 0.3, 0.8}[static_cast<std::size_t>(trial % 4)];
    const std::size_t bodies = 1 + static_cast<std::size_t>(trial) % 8;
    const ConeProblem problem = test::random_island(random, bodies, 60, mu, 1e-9);
    ConeSolution exact;
    ConeSolution iterative;
    solve_exact(problem, nullptr, 1e-12, exact);
    GaussSeidelSolver().solve(problem, nullptr, 1e-11, 30000, iterative);
    EXPECT_TRUE(exact.converged) << trial << " mu " << mu << " n " << problem.size() << " residual "
                                 << exact.residual;
    EXPECT_TRUE(iterative.converged)
        << trial << " mu " << mu << " residual " << iterative.residual << " n " << problem.size();
    most_iterations = std::max(most_iterations, exact.iterations);
    if (mu <= 0.3) {
      EXPECT_LE((exact.y - iterative.y).lpNorm<Eigen::Infinity>(), 1e-6)
          << trial << " mu " << mu << " n " << problem.size();
    }
  }
  RecordProperty("exact_iterations_max", most_iterations);
}

TEST(Solvers, IterativeTakesHardlyMoreSweepsForLargeIslands) {
  const auto mean_sweeps = [](std::size_t bodies) {
    Random random(21);
    double sum = 0.0;
    for (int trial = 0; trial < 10; ++trial) {
      const ConeProblem problem = test::random_island(random, bodies, 4 * bodies, 0.3, 1e-9);
      ConeSolution solution;
      GaussSeidelSolver().solve(problem, nullptr, 1e-6, 20000, solution);
      EXPECT_TRUE(solution.converged) << bodies << " trial " << trial;
      sum += solution.iterations;
    }
    return sum / 10.0;
  };
  const double small = mean_sweeps(100);
  const double large = mean_sweeps(1000);
  RecordProperty("sweeps_100_bodies", std::to_string(small));
  RecordProperty("sweeps_1000_bodies", std::to_string(large));
  EXPECT_LE(large, 1.2 * small);
}

TEST(Sweeps, PartsAreWhatIsUnsolvedAndItsNeighbours) {
  // A chain of ten bodies, each in touch with the next; solved but for one contact.
  ConeProblem problem;
  problem.clear();
  problem.blocks = 10;
  problem.y_free.setZero(60);
  for (std::uint32_t b = 0; b < 9; ++b) {
    Jacobian J = Jacobian::Zero();
    J.leftCols<3>().setIdentity();
    problem.couplings.push_back({b, J});
    problem.couplings.push_back({b + 1, -J});
    problem.first.push_back(static_cast<std::uint32_t>(problem.couplings.size()));
    problem.bias.push_back(b == 4 ? Vec3(-1, 0, 0) : Vec3::Zero());
    problem.friction.push_back(0.0);
  }
  ConeSolution solution;
  solution.p.assign(9, Vec3::Zero());
  solution.y = problem.y_free;
  const std::vector<ContactSubset> parts = unsolved_parts(problem, solution, 0.1);
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts[0].contacts, (std::vector<std::uint32_t>{3, 4, 5}));
  EXPECT_EQ(parts[0].blocks, (std::vector<std::uint32_t>{3, 4, 5, 6}));
  EXPECT_TRUE(unsolved_parts(problem, solution, 2.0).empty());
}

TEST(Solvers, ExactSolvesIslandsOfManyBodiesAndRedundantContacts) {
  Random random(5);
  int most_iterations = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const ConeProblem problem = test::random_island(random, 30, 300, 0.5, 1e-9);
    ASSERT_GE(problem.size(), 90U);
    ConeSolution solution;
    solve_exact(problem, nullptr, 1e-12, solution);
    EXPECT_LE(solution.residual, 1e-8) << trial << " n " << problem.size();
    EXPECT_LE((solution.y - velocities_of(problem, solution.p)).norm(), 1e-12);
    most_iterations = std::max(most_iterations, solution.iterations);
  }
  RecordProperty("iterations_max", most_iterations);
}

TEST(Solvers, InteriorPointAloneComesNearTheSolution) {
  Random random(6);
  for (int trial = 0; trial < 20; ++trial) {
    const double mu = std::vector<double>{0.0, 0.1, 0.2, 0.3}[static_cast<std::size_t>(trial % 4)];
    const ConeProblem problem = test::random_island(random, 10, 60, mu, 1e-9);
    ConeSolution solution;
    InteriorPointSolver().solve(problem, nullptr, 1e-12, solution);
    EXPECT_LE(solution.residual, 1e-6 * velocity_scale(problem)) << trial << " mu " << mu;
    for (std::size_t i = 0; i < problem.size(); ++i) {
      EXPECT_LE(solution.p[i].tail<2>().norm(), mu * solution.p[i].x() * (1.0 + 1e-12));
    }
    // From its own solution it takes few steps.
    ConeSolution again;
    InteriorPointSolver().solve(problem, &solution, 1e-12, again);
    EXPECT_LT(again.iterations, solution.iterations) << trial << " mu " << mu;
  }
}

TEST(Solvers, InteriorPointNeedsFiniteFriction) {
  Random random(8);
  ConeProblem problem = test::random_island(random, 2, 6, 0.3, 1e-9);
  EXPECT_TRUE(InteriorPointSolver::suits(problem));
  problem.friction.back() = ConeProblem::unlimited;
  EXPECT_FALSE(InteriorPointSolver::suits(problem));
}

}  // namespace
}  // namespace gotai::impulse
