#include "gotai/impulse/contact_sweeps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "gotai/impulse/disjoint_sets.h"

namespace gotai::impulse {
namespace {

constexpr int sweeps_per_check = 5;
constexpr double tolerated_growth = 4.0;  // of a sweep's squared change over the least so far

std::span<const Coupling> couplings_of(const ConeProblem& problem, std::size_t contact) {
  return std::span(problem.couplings)
      .subspan(problem.first[contact], problem.first[contact + 1] - problem.first[contact]);
}

double residual_of(const ConeProblem& problem, const ContactSubset& subset,
                   const ConeSolution& solution) {
  double worst = 0.0;
  for (const std::uint32_t i : subset.contacts) {
    worst = std::max(worst, natural_map_residual(problem, i, solution.p[i], solution.y));
  }
  return worst;
}

// Nesterov's sequence t_{k+1} = (1 + sqrt(1 + 4 t_k^2)) / 2; the momentum is (t_k - 1) / t_{k+1}.
struct Momentum {
  double t = 1.0;
  double least = std::numeric_limits<double>::infinity();  // squared change since the last start

  double next(double against, double change) {
    if (against > 0.0 || change > tolerated_growth * least) *this = {};
    least = std::min(least, change);
    const double last = t;
    t = 0.5 * (1.0 + std::sqrt(1.0 + 4.0 * t * t));
    return (last - 1.0) / t;
  }
};

}  // namespace

void ContactSweeps::prepare(const ConeProblem& problem) {
  const std::size_t n = problem.size();
  normal_step_.resize(n);
  tangential_step_.resize(n);
  inertness_.resize(n);
  before_.resize(n);
  last_.resize(n);
  last_y_.resize(problem.y_free.size());
  visits_ = 0;
  for (std::size_t i = 0; i < n; ++i) {
    Mat3 A = Mat3::Zero();
    for (const Coupling& coupling : couplings_of(problem, i)) {
      A.noalias() += coupling.J * coupling.J.transpose();
    }
    normal_step_[i] = 1.0 / A(0, 0);
    const double bound = std::max(A(1, 1), A(2, 2)) + std::abs(A(1, 2));
    tangential_step_[i] = problem.friction[i] > 0.0 ? 1.0 / bound : 0.0;
    inertness_[i] = problem.inertness(i);
  }
}

int ContactSweeps::sweeps_done() const {
  const std::size_t n = normal_step_.size();
  return n == 0 ? 0 : static_cast<int>((visits_ + n - 1) / n);
}

void ContactSweeps::sweep(const ConeProblem& problem, const ContactSubset& subset,
                          ConeSolution& solution) {
  visits_ += subset.contacts.size();
  for (const std::uint32_t i : subset.contacts) {
    const double mu = problem.friction[i];
    const Vec3 p = solution.p[i];
    const Vec3 c = problem.velocity(i, solution.y);
    const double normal = std::max(0.0, p.x() - normal_step_[i] * c.x());
    if (normal == 0.0 && p.isZero(0.0) && std::isfinite(mu)) continue;
    Vec3 next(normal, 0.0, 0.0);
    if (mu > 0.0) {
      // The tangents see the new normal impulse.
      Vec3 pushed = c;
      for (const Coupling& coupling : couplings_of(problem, i)) {
        const Jacobian& J = coupling.J;
        pushed.tail<2>().noalias() += (normal - p.x()) * (J.bottomRows<2>() * J.row(0).transpose());
      }
      const Vec2 trial = p.tail<2>() - tangential_step_[i] * pushed.tail<2>();
      next = project_on_friction({normal, trial.x(), trial.y()}, mu);
    }
    problem.add_impulse(i, next - p, solution.y);
    solution.p[i] = next;
  }
}

void ContactSweeps::extrapolate(const ContactSubset& subset, double momentum,
                                ConeSolution& solution) {
  for (const std::uint32_t i : subset.contacts) {
    const Vec3 p = solution.p[i];
    solution.p[i] += momentum * (p - last_[i]);
    last_[i] = p;
  }
  for (const std::uint32_t b : subset.blocks) {
    auto y = solution.y.segment<6>(Eigen::Index{6} * b);
    auto last = last_y_.segment<6>(Eigen::Index{6} * b);
    const Eigen::Matrix<double, 6, 1> swept = y;
    y += momentum * (swept - last);
    last = swept;
  }
}

void ContactSweeps::run(const ConeProblem& problem, const ContactSubset& subset, int sweeps,
                        double limit, ConeSolution& solution) {
  for (const std::uint32_t i : subset.contacts) last_[i] = solution.p[i];
  for (const std::uint32_t b : subset.blocks) {
    last_y_.segment<6>(Eigen::Index{6} * b) = solution.y.segment<6>(Eigen::Index{6} * b);
  }
  Momentum momentum;
  for (int k = 1;; ++k) {
    for (const std::uint32_t i : subset.contacts) before_[i] = solution.p[i];
    sweep(problem, subset, solution);
    if (k >= sweeps) return;
    if (k % sweeps_per_check == 0 && residual_of(problem, subset, solution) <= limit) return;
    double against = 0.0;  // of the sweep to the momentum, in the metric of A's diagonal
    double change = 0.0;
    for (const std::uint32_t i : subset.contacts) {
      const Vec3 swept = solution.p[i] - before_[i];
      against -= inertness_[i] * swept.dot(solution.p[i] - last_[i]);
      change += inertness_[i] * swept.squaredNorm();
    }
    extrapolate(subset, momentum.next(against, change), solution);
  }
}

ContactSubset all_contacts(const ConeProblem& problem) {
  ContactSubset all;
  all.contacts.resize(problem.size());
  all.blocks.resize(problem.blocks);
  std::iota(all.contacts.begin(), all.contacts.end(), 0U);
  std::iota(all.blocks.begin(), all.blocks.end(), 0U);
  return all;
}

namespace {

// Blocks of contacts above the limit and the neighbours of those.
std::vector<bool> unsolved_blocks(const ConeProblem& problem, const ConeSolution& solution,
                                  double limit) {
  std::vector<bool> marked(problem.blocks, false);
  for (std::size_t i = 0; i < problem.size(); ++i) {
    if (natural_map_residual(problem, i, solution.p[i], solution.y) <= limit) continue;
    for (const Coupling& coupling : couplings_of(problem, i)) marked[coupling.block] = true;
  }
  std::vector<bool> grown = marked;
  for (std::size_t i = 0; i < problem.size(); ++i) {
    const auto couplings = couplings_of(problem, i);
    if (std::none_of(couplings.begin(), couplings.end(),
                     [&](const Coupling& coupling) { return marked[coupling.block]; })) {
      continue;
    }
    for (const Coupling& coupling : couplings) grown[coupling.block] = true;
  }
  return grown;
}

}  // namespace

std::vector<ContactSubset> unsolved_parts(const ConeProblem& problem, const ConeSolution& solution,
                                          double limit) {
  const std::vector<bool> inside = unsolved_blocks(problem, solution, limit);
  const auto is_inside = [&](std::size_t i) {
    const auto couplings = couplings_of(problem, i);
    return std::all_of(couplings.begin(), couplings.end(),
                       [&](const Coupling& coupling) { return inside[coupling.block]; });
  };
  DisjointSets touching(problem.blocks);
  for (std::size_t i = 0; i < problem.size(); ++i) {
    if (!is_inside(i)) continue;
    const auto couplings = couplings_of(problem, i);
    for (const Coupling& coupling : couplings) {
      touching.join(couplings.front().block, coupling.block);
    }
  }

  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> part_of(problem.blocks, none);  // by least block
  std::vector<ContactSubset> parts;
  for (std::uint32_t i = 0; i < problem.size(); ++i) {
    if (!is_inside(i)) continue;
    std::uint32_t& part = part_of[touching.least(couplings_of(problem, i).front().block)];
    if (part == none) {
      part = static_cast<std::uint32_t>(parts.size());
      parts.emplace_back();
    }
    parts[part].contacts.push_back(i);
  }
  for (std::uint32_t b = 0; b < problem.blocks; ++b) {
    const std::uint32_t part = part_of[touching.least(b)];
    if (inside[b] && part != none) parts[part].blocks.push_back(b);
  }
  return parts;
}

}  // namespace gotai::impulse
