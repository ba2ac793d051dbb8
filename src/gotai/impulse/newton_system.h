/// @file
/// The linear system of one Newton step of a contact problem.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>
#include <vector>

#include "gotai/impulse/cone_problem.h"

namespace gotai::impulse {

/// Solves (I + sum_i J_i' D_i J_i) dy = r in the 6 x blocks velocities: its size does not depend on
/// the number of contacts. Dense up to a few bodies, sparse above.
class NewtonSystem {
 public:
  /// Prepares storage and structure for a problem; call it before solve() and after every change of
  /// the couplings.
  void analyse(const ConeProblem& problem);

  /// @param D          3 x 3 per contact [kg]
  /// @param symmetric  all D are symmetric and positive semidefinite
  /// @return false when the matrix is singular to working precision
  bool factorise(const ConeProblem& problem, const std::vector<Mat3>& D, bool symmetric);
  /// @param[in,out] r  right-hand side, replaced by the solution
  /// @return false when the solution is not finite
  bool solve(Eigen::VectorXd& r) const;

 private:
  using Block = Eigen::Matrix<double, 6, 6>;

  bool factorise_dense(const ConeProblem& problem, const std::vector<Mat3>& D);
  bool factorise_sparse(const ConeProblem& problem, const std::vector<Mat3>& D);
  void analyse_sparse(const ConeProblem& problem);

  bool dense_ = true;
  bool symmetric_ = true;
  Eigen::MatrixXd H_;
  Eigen::LLT<Eigen::MatrixXd> dense_symmetric_;
  Eigen::PartialPivLU<Eigen::MatrixXd> dense_general_;

  // Sparse: blocks by column, rows ascending; slots_ lists, contact by contact, where the products
  // of its couplings go.
  std::vector<std::uint32_t> column_begin_;
  std::vector<std::uint32_t> row_;
  std::vector<std::uint32_t> slots_;
  std::vector<Block> values_;
  Eigen::SparseMatrix<double> S_;
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> sparse_symmetric_;
  Eigen::SparseLU<Eigen::SparseMatrix<double>> sparse_general_;
};

}  // namespace gotai::impulse
