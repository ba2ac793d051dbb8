#include "gotai/impulse/newton_system.h"

#include <algorithm>
#include <utility>

namespace gotai::impulse {
namespace {

constexpr std::size_t largest_dense = 16;  // bodies; above, sparse factors are cheaper

// Calls visit(row coupling, column coupling) for every pair of couplings of every contact.
template <typename Visit>
void for_each_product(const ConeProblem& problem, const Visit& visit) {
  for (std::size_t i = 0; i < problem.size(); ++i) {
    for (std::uint32_t k = problem.first[i]; k < problem.first[i + 1]; ++k) {
      for (std::uint32_t l = problem.first[i]; l < problem.first[i + 1]; ++l) {
        visit(i, problem.couplings[k], problem.couplings[l]);
      }
    }
  }
}

}  // namespace

void NewtonSystem::analyse(const ConeProblem& problem) {
  dense_ = problem.blocks <= largest_dense;
  if (!dense_) analyse_sparse(problem);
}

void NewtonSystem::analyse_sparse(const ConeProblem& problem) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> entries;  // (column, row)
  for (std::uint32_t b = 0; b < problem.blocks; ++b) entries.emplace_back(b, b);
  for_each_product(problem, [&](std::size_t, const Coupling& row, const Coupling& column) {
    entries.emplace_back(column.block, row.block);
  });
  std::sort(entries.begin(), entries.end());
  entries.erase(std::unique(entries.begin(), entries.end()), entries.end());

  column_begin_.assign(problem.blocks + 1, 0);
  row_.clear();
  for (const auto& [column, row] : entries) {
    ++column_begin_[column + 1];
    row_.push_back(row);
  }
  for (std::size_t b = 0; b < problem.blocks; ++b) column_begin_[b + 1] += column_begin_[b];
  values_.resize(row_.size());

  slots_.clear();
  for_each_product(problem, [&](std::size_t, const Coupling& row, const Coupling& column) {
    const auto at =
        std::lower_bound(entries.begin(), entries.end(), std::make_pair(column.block, row.block));
    slots_.push_back(static_cast<std::uint32_t>(at - entries.begin()));
  });

  const auto n = static_cast<Eigen::Index>(6 * problem.blocks);
  S_.resize(n, n);
  S_.resizeNonZeros(static_cast<Eigen::Index>(36 * row_.size()));
  int at = 0;
  for (std::size_t b = 0; b < problem.blocks; ++b) {
    for (int j = 0; j < 6; ++j) {
      S_.outerIndexPtr()[6 * b + static_cast<std::size_t>(j)] = at;
      for (std::uint32_t e = column_begin_[b]; e < column_begin_[b + 1]; ++e) {
        for (int i = 0; i < 6; ++i) S_.innerIndexPtr()[at++] = static_cast<int>(6 * row_[e]) + i;
      }
    }
  }
  S_.outerIndexPtr()[n] = at;
}

bool NewtonSystem::factorise(const ConeProblem& problem, const std::vector<Mat3>& D,
                             bool symmetric) {
  symmetric_ = symmetric;
  return dense_ ? factorise_dense(problem, D) : factorise_sparse(problem, D);
}

bool NewtonSystem::solve(Eigen::VectorXd& r) const {
  if (dense_) {
    if (symmetric_) {
      dense_symmetric_.solveInPlace(r);
    } else {
      r = dense_general_.solve(r).eval();
    }
  } else {
    r = symmetric_ ? sparse_symmetric_.solve(r).eval() : sparse_general_.solve(r).eval();
  }
  return r.allFinite();
}

bool NewtonSystem::factorise_dense(const ConeProblem& problem, const std::vector<Mat3>& D) {
  const auto n = static_cast<Eigen::Index>(6 * problem.blocks);
  H_.setIdentity(n, n);
  Jacobian DJ;
  for (std::size_t i = 0; i < problem.size(); ++i) {
    if (D[i].isZero(0.0)) continue;
    for (std::uint32_t l = problem.first[i]; l < problem.first[i + 1]; ++l) {
      DJ.noalias() = D[i] * problem.couplings[l].J;
      for (std::uint32_t k = problem.first[i]; k < problem.first[i + 1]; ++k) {
        H_.block<6, 6>(Eigen::Index{6} * problem.couplings[k].block,
                       Eigen::Index{6} * problem.couplings[l].block)
            .noalias() += problem.couplings[k].J.transpose() * DJ;
      }
    }
  }
  if (symmetric_) {
    dense_symmetric_.compute(H_);
    return dense_symmetric_.info() == Eigen::Success;
  }
  dense_general_.compute(H_);
  return true;
}

bool NewtonSystem::factorise_sparse(const ConeProblem& problem, const std::vector<Mat3>& D) {
  std::fill(values_.begin(), values_.end(), Block::Zero());
  for (std::uint32_t b = 0; b < problem.blocks; ++b) {
    const auto begin = row_.begin() + column_begin_[b];
    const auto end = row_.begin() + column_begin_[b + 1];
    values_[static_cast<std::size_t>(std::lower_bound(begin, end, b) - row_.begin())].setIdentity();
  }
  std::size_t slot = 0;
  for_each_product(problem, [&](std::size_t i, const Coupling& row, const Coupling& column) {
    Block& value = values_[slots_[slot++]];
    if (!D[i].isZero(0.0)) value.noalias() += row.J.transpose() * (D[i] * column.J).eval();
  });
  double* out = S_.valuePtr();
  for (std::size_t b = 0; b < problem.blocks; ++b) {
    for (int j = 0; j < 6; ++j) {
      for (std::uint32_t e = column_begin_[b]; e < column_begin_[b + 1]; ++e) {
        for (int i = 0; i < 6; ++i) *out++ = values_[e](i, j);
      }
    }
  }
  if (symmetric_) {
    sparse_symmetric_.compute(S_);
    return sparse_symmetric_.info() == Eigen::Success;
  }
  sparse_general_.compute(S_);
  return sparse_general_.info() == Eigen::Success;
}

}  // namespace gotai::impulse
