/// @file
/// Contact problems for tests of solvers, without a world.
#pragma once

#include <Eigen/Eigenvalues>
#include <cmath>

#include "gotai/core/random.h"
#include "gotai/impulse/cone_problem.h"

namespace gotai::test {

/// A frictionless problem with a given matrix and vector: w = A p + q. A = B B' by eigenvectors,
/// and the columns of B are spread over as many blocks as they need.
inline impulse::ConeProblem lcp_problem(const Eigen::MatrixXd& A, const Eigen::VectorXd& q,
                                        double ridge) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(A);
  const Eigen::VectorXd root = eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  const Eigen::MatrixXd B = eigen.eigenvectors() * root.asDiagonal();
  impulse::ConeProblem problem;
  problem.clear();
  problem.blocks = static_cast<std::size_t>((A.rows() + 5) / 6);
  problem.y_free.setZero(static_cast<Eigen::Index>(6 * problem.blocks));
  problem.patch = {0};
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    for (std::uint32_t b = 0; b < problem.blocks; ++b) {
      impulse::Coupling coupling{b, impulse::Jacobian::Zero()};
      const Eigen::Index column = Eigen::Index{6} * b;
      const Eigen::Index count = std::min<Eigen::Index>(6, A.cols() - column);
      coupling.J.row(0).head(count) = B.row(i).segment(column, count);
      problem.couplings.push_back(coupling);
    }
    problem.first.push_back(static_cast<std::uint32_t>(problem.couplings.size()));
    problem.bias.emplace_back(q[i], 0.0, 0.0);
    problem.friction.push_back(0.0);
    problem.patch.push_back(static_cast<std::uint32_t>(i + 1));
  }
  impulse::set_compliance(problem, std::vector<double>(problem.size(), 1.0), ridge);
  return problem;
}

/// A random island: a chain of bodies with random contacts between neighbours and with the ground.
/// Blocks are mass-scaled by random masses 0.1..10 and inertias.
inline impulse::ConeProblem random_island(Random& random, std::size_t bodies,
                                          std::size_t max_contacts, double friction, double ridge) {
  impulse::ConeProblem problem;
  problem.clear();
  problem.blocks = bodies;
  const auto n = static_cast<Eigen::Index>(6 * bodies);
  problem.y_free.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) problem.y_free[i] = random.normal();
  std::vector<double> mass(bodies);
  for (double& m : mass) m = std::pow(10.0, random.uniform(-1.0, 1.0));
  const auto jacobian = [&](std::size_t b, const Mat3& frame, const Vec3& arm) {
    impulse::Jacobian J;
    J.leftCols<3>() = frame.transpose() / std::sqrt(mass[b]);
    for (int row = 0; row < 3; ++row) {
      J.block<1, 3>(row, 3) = arm.cross(frame.col(row)).transpose() / std::sqrt(0.1 * mass[b]);
    }
    return J;
  };
  problem.patch = {0};
  for (std::uint32_t b = 0; b < bodies && problem.size() < max_contacts; ++b) {
    const bool ground = b == 0 || random.uniform() < 0.5;
    const std::size_t count = 1 + random.next_u32() % (max_contacts / bodies);
    const Mat3 base = random.rotation().toRotationMatrix();
    for (std::size_t k = 0; k < count; ++k) {
      const Mat3 tilt =
          Eigen::AngleAxisd(0.3 * random.uniform(), random.unit_vector()).toRotationMatrix();
      const Mat3 frame = tilt * base;
      problem.couplings.push_back(
          {b, jacobian(b, frame, 0.5 * random.unit_vector() - 0.3 * frame.col(0))});
      if (!ground) {
        problem.couplings.push_back(
            {b - 1, -jacobian(b - 1, frame, 0.5 * random.unit_vector() + 0.3 * frame.col(0))});
      }
      problem.first.push_back(static_cast<std::uint32_t>(problem.couplings.size()));
      problem.bias.push_back(Vec3::Zero());
      problem.friction.push_back(friction);
      // Restitution 0.5 of what approaches, per contact (erratum 4).
      const double v = problem.velocity(problem.size() - 1, problem.y_free).x();
      problem.bias.back().x() = 0.5 * std::min(v, 0.0);
    }
    problem.patch.push_back(static_cast<std::uint32_t>(problem.size()));
  }
  impulse::set_compliance(problem, std::vector<double>(problem.size(), 1.0), ridge);
  return problem;
}

/// All of A = J J' [3n x 3n], contact by contact (normal, tangent, tangent).
inline Eigen::MatrixXd delassus(const impulse::ConeProblem& problem) {
  const auto n = static_cast<Eigen::Index>(problem.size());
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(3 * n, static_cast<Eigen::Index>(6 * problem.blocks));
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    for (std::uint32_t k = problem.first[at]; k < problem.first[at + 1]; ++k) {
      J.block<3, 6>(3 * i, Eigen::Index{6} * problem.couplings[k].block) = problem.couplings[k].J;
    }
  }
  return J * J.transpose();
}

/// c without impulses, stacked [3n].
inline Eigen::VectorXd free_velocities(const impulse::ConeProblem& problem) {
  Eigen::VectorXd q(static_cast<Eigen::Index>(3 * problem.size()));
  for (std::size_t i = 0; i < problem.size(); ++i) {
    q.segment<3>(static_cast<Eigen::Index>(3 * i)) = problem.velocity(i, problem.y_free);
  }
  return q;
}

}  // namespace gotai::test
