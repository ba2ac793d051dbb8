#include "gotai/impulse/gauss_seidel_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gotai/impulse/exact_solver.h"

namespace gotai::impulse {
namespace {

constexpr int sweeps_per_round = 40;
constexpr double worthwhile_progress = 0.8;  // of a round: residual after / before
constexpr std::size_t largest_part = 64;     // bodies of a part that is solved exactly
constexpr double solved = 0.5;               // residual of contacts that need no sweep / limit

// Appends a contact to a problem on some of the blocks.
void append_contact(const ConeProblem& problem, std::size_t i,
                    const std::vector<std::uint32_t>& blocks, ConeProblem& part) {
  for (std::uint32_t c = problem.first[i]; c < problem.first[i + 1]; ++c) {
    Coupling coupling = problem.couplings[c];
    coupling.block = static_cast<std::uint32_t>(
        std::find(blocks.begin(), blocks.end(), coupling.block) - blocks.begin());
    part.couplings.push_back(coupling);
  }
  part.first.push_back(static_cast<std::uint32_t>(part.couplings.size()));
  part.bias.push_back(problem.bias[i]);
  part.friction.push_back(problem.friction[i]);
  part.compliance.push_back(problem.compliance[i]);
}

void measure(const ConeProblem& problem, double limit, ConeSolution& solution) {
  solution.y = velocities_of(problem, solution.p);  // no drift from the updates
  solution.residual = natural_map_residual(problem, solution.p, solution.y);
  solution.converged = solution.residual <= limit;
}

}  // namespace

void GaussSeidelSolver::solve(const ConeProblem& problem, const std::vector<Vec3>* guess,
                              double limit, int max_sweeps, ConeSolution& solution) {
  if (guess != nullptr) {
    solution.p = *guess;
  } else {
    solution.p.assign(problem.size(), Vec3::Zero());
  }
  cut(problem);
  sweeps_.prepare(problem);
  solution.y = velocities_of(problem, solution.p);
  int patch_sweeps = 0;
  int exact_rounds = 0;
  const auto sweeps_done = [&] { return patch_sweeps + exact_rounds + sweeps_.sweeps_done(); };
  const auto sweeps_left = [&] { return max_sweeps - sweeps_done(); };

  sweeps_.run(problem, all_contacts(problem), std::min(sweeps_per_round, max_sweeps), limit,
              solution);
  measure(problem, limit, solution);
  // Contact sweeps, then patch sweeps, each as long as they pay; the first patch sweep is over all
  // patches and makes the shares even.
  for (bool all = true; all || !solution.converged; all = false) {
    while (!solution.converged && sweeps_left() > 0) {
      const double before = solution.residual;
      sweep_unsolved(problem, sweeps_left(), limit, solution);
      measure(problem, limit, solution);
      if (solution.residual > worthwhile_progress * before) break;
    }
    bool pays = all || !solution.converged;
    for (bool first = all; pays && sweeps_left() > 0; first = false) {
      const double before = solution.residual;
      kept_ = solution.p;
      sweep_patches(problem, limit, first, solution);
      ++patch_sweeps;
      measure(problem, limit, solution);
      if (!first && solution.residual > before) {
        solution.p = kept_;
        measure(problem, limit, solution);
      }
      pays = !solution.converged && solution.residual <= worthwhile_progress * before;
    }
    if (sweeps_left() <= 0) break;
    if (!solution.converged) {
      solve_parts(problem, limit, solution);
      ++exact_rounds;
      measure(problem, limit, solution);
    }
  }
  solution.iterations = sweeps_done();
}

// Where most is unsolved, all contacts: parts pay when they are small.
void GaussSeidelSolver::sweep_unsolved(const ConeProblem& problem, int sweeps, double limit,
                                       ConeSolution& solution) {
  const std::vector<ContactSubset> parts = unsolved_parts(problem, solution, solved * limit);
  std::size_t contacts = 0;
  for (const ContactSubset& part : parts) contacts += part.contacts.size();
  sweeps = std::min(sweeps, sweeps_per_round);
  if (2 * contacts > problem.size()) {
    sweeps_.run(problem, all_contacts(problem), sweeps, limit, solution);
  } else {
    for (const ContactSubset& part : parts) {
      sweeps_.run(problem, part, 2 * sweeps, solved * limit, solution);
    }
  }
}

// Where neither kind of sweep gets on, the few bodies around are solved together exactly, as they
// are pushed by the contacts outside.
void GaussSeidelSolver::solve_parts(const ConeProblem& problem, double limit,
                                    ConeSolution& solution) {
  for (const ContactSubset& part : unsolved_parts(problem, solution, solved * limit)) {
    if (part.blocks.size() > largest_part) continue;
    ConeProblem local;
    local.clear();
    local.blocks = part.blocks.size();
    local.y_free.resize(static_cast<Eigen::Index>(6 * local.blocks));
    for (std::size_t b = 0; b < local.blocks; ++b) {
      local.y_free.segment<6>(static_cast<Eigen::Index>(6 * b)) =
          solution.y.segment<6>(Eigen::Index{6} * part.blocks[b]);
    }
    guess_.clear();
    for (const std::uint32_t i : part.contacts) {
      append_contact(problem, i, part.blocks, local);
      guess_.push_back(solution.p[i]);
    }
    for (std::size_t k = 0; k < guess_.size(); ++k) local.add_impulse(k, -guess_[k], local.y_free);
    const double before = natural_map_residual(local, guess_, velocities_of(local, guess_));
    ConeSolution exact;
    solve_exact(local, &guess_, 0.1 * limit, exact);
    if (!(exact.residual < before)) continue;
    for (std::size_t k = 0; k < guess_.size(); ++k) {
      const std::uint32_t i = part.contacts[k];
      problem.add_impulse(i, exact.p[k] - guess_[k], solution.y);
      solution.p[i] = exact.p[k];
    }
  }
}

// All patches, so that guessed and swept shares become even ones, or those that are not solved yet.
void GaussSeidelSolver::sweep_patches(const ConeProblem& problem, double limit, bool all,
                                      ConeSolution& solution) {
  for (Patch& patch : patches_) {
    if (all || residual(problem, patch, solution) > 0.1 * limit) {
      update(problem, patch, 0.1 * limit, solution);
    }
  }
}

void GaussSeidelSolver::cut(const ConeProblem& problem) {
  patches_.resize(problem.patch.empty() ? 0 : problem.patch.size() - 1);
  for (std::size_t k = 0; k < patches_.size(); ++k) {
    Patch& patch = patches_[k];
    patch.begin = problem.patch[k];
    patch.problem.clear();
    patch.blocks.clear();
    for (std::uint32_t i = problem.patch[k]; i < problem.patch[k + 1]; ++i) {
      for (std::uint32_t c = problem.first[i]; c < problem.first[i + 1]; ++c) {
        const std::uint32_t block = problem.couplings[c].block;
        if (std::find(patch.blocks.begin(), patch.blocks.end(), block) == patch.blocks.end()) {
          patch.blocks.push_back(block);
        }
      }
      append_contact(problem, i, patch.blocks, patch.problem);
    }
    patch.problem.blocks = patch.blocks.size();
    patch.problem.y_free.resize(static_cast<Eigen::Index>(6 * patch.blocks.size()));
  }
}

double GaussSeidelSolver::residual(const ConeProblem& problem, const Patch& patch,
                                   const ConeSolution& solution) const {
  double worst = 0.0;
  for (std::size_t k = 0; k < patch.problem.size(); ++k) {
    worst = std::max(worst, natural_map_residual(problem, patch.begin + k,
                                                 solution.p[patch.begin + k], solution.y));
  }
  return worst;
}

void GaussSeidelSolver::update(const ConeProblem& problem, Patch& patch, double limit,
                               ConeSolution& solution) {
  ConeProblem& local = patch.problem;
  const std::size_t n = local.size();
  guess_.assign(solution.p.begin() + patch.begin,
                solution.p.begin() + patch.begin + static_cast<std::ptrdiff_t>(n));
  for (std::size_t b = 0; b < patch.blocks.size(); ++b) {
    local.y_free.segment<6>(static_cast<Eigen::Index>(6 * b)) =
        solution.y.segment<6>(Eigen::Index{6} * patch.blocks[b]);
  }
  for (std::size_t i = 0; i < n; ++i) local.add_impulse(i, -guess_[i], local.y_free);

  newton_.solve(local, &guess_, limit, patch.solution);
  if (!patch.solution.converged) return;  // left to the contact sweeps
  for (std::size_t i = 0; i < n; ++i) {
    problem.add_impulse(patch.begin + i, patch.solution.p[i] - guess_[i], solution.y);
    solution.p[patch.begin + i] = patch.solution.p[i];
  }
}

}  // namespace gotai::impulse
