#include "gotai/impulse/newton_solver.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace gotai::impulse {
namespace {

constexpr double softest = 1e9;  // first compliance of approach(), times the stated one
constexpr int compliances = 10;  // of approach(), a tenth each time: the last is the stated one
constexpr int steps_per_compliance = 12;
constexpr int polish_steps = 30;
constexpr int refine_steps = 12;
constexpr int guess_steps = 10;  // of polish() from a guess before approach() is tried
// Proximal steps: compliances, times the stated one, each used as long as it pays.
constexpr std::array<double, 6> proximal_softness = {1e6, 1e5, 1e6, 1e4, 1e5, 1e3};
constexpr int proximal_rounds = 8;
constexpr int proximal_polish_steps = 15;
constexpr double worthwhile_descent = 0.9;  // residual after / before

// What a contact does; the projection on the friction law is smooth within each mode.
enum class Mode { open, stick, slide };

Mode mode_of(const Vec3& z, double friction) {
  if (std::isinf(friction)) return Mode::stick;
  if (z.x() <= 0.0) return Mode::open;
  if (friction == 0.0) return Mode::slide;
  return std::hypot(z.y(), z.z()) <= friction * z.x() ? Mode::stick : Mode::slide;
}

// Direction of the friction of a sliding contact; zero without friction.
Vec2 slide_direction(const Vec3& z, double friction) {
  return friction == 0.0 ? Vec2::Zero().eval() : z.tail<2>().normalized();
}

// mu z_N / |z_T|, in [0, 1) for a sliding contact.
double slide_ratio(const Vec3& z, double friction) {
  return friction == 0.0 ? 0.0 : friction * z.x() / std::hypot(z.y(), z.z());
}

}  // namespace

void NewtonSolver::start(const ConeProblem& problem, ConeSolution& solution) {
  const std::size_t n = problem.size();
  solution.iterations = 0;
  solution.p.assign(n, Vec3::Zero());
  solution.y = problem.y_free;
  system_.analyse(problem);
  inertness_.resize(n);
  for (std::size_t i = 0; i < n; ++i) inertness_[i] = problem.inertness(i);
  D_.resize(n);
  p_.resize(n);
  defect_.resize(n);
}

void NewtonSolver::solve(const ConeProblem& problem, const std::vector<Vec3>* guess, double limit,
                         ConeSolution& solution) {
  start(problem, solution);
  if (guess != nullptr) {
    solution.p = *guess;
    solution.y = velocities_of(problem, solution.p);
    if (polish_twice(problem, limit, guess_steps, solution)) return;
    solution.y = problem.y_free;
  }
  approach(problem, solution);
  polish_twice(problem, limit, polish_steps, solution);
}

void NewtonSolver::refine(const ConeProblem& problem, const std::vector<Vec3>& guess, double limit,
                          ConeSolution& solution) {
  start(problem, solution);
  solution.p = guess;
  solution.y = velocities_of(problem, solution.p);
  if (polish_twice(problem, limit, refine_steps, solution)) return;
  solution.p = guess;
  polish_proximally(problem, limit, solution);
}

// Steps that do not lower the residual are undone, so that the guess is the worst outcome.
void NewtonSolver::polish_proximally(const ConeProblem& problem, double limit,
                                     ConeSolution& solution) {
  solution.y = velocities_of(problem, solution.p);
  solution.residual = natural_map_residual(problem, solution.p, solution.y);
  for (const double softness : proximal_softness) {
    softness_ = softness;
    for (int round = 0; round < proximal_rounds && solution.residual > limit; ++round) {
      const double before = solution.residual;
      reference_ = solution.p;
      polish(problem, limit, 1, proximal_polish_steps, solution);
      solution.y = velocities_of(problem, solution.p);
      solution.residual = natural_map_residual(problem, solution.p, solution.y);
      if (!(solution.residual < before)) {
        solution.p = reference_;
        solution.y = velocities_of(problem, solution.p);
        solution.residual = before;
      }
      if (solution.residual > worthwhile_descent * before) break;
    }
  }
  softness_ = 1.0;
  solution.converged = solution.residual <= limit;
}

// Impulses p_ = P(-c / (softness R)) and their derivative D_ at y; returns |F|, F = y - y_free - J'
// p.
double NewtonSolver::evaluate(const ConeProblem& problem, double softness,
                              const Eigen::VectorXd& y) {
  F_ = problem.y_free - y;  // minus the residual: the right-hand side of a step
  for (std::size_t i = 0; i < problem.size(); ++i) {
    const double stiffness = 1.0 / (softness * problem.compliance[i]);
    const double mu = problem.friction[i];
    const Vec3 z = -stiffness * problem.velocity(i, y);
    p_[i] = project_on_friction(z, mu);
    D_[i].setZero();
    const Mode mode = mode_of(z, mu);
    if (mode == Mode::stick) {
      D_[i].diagonal().setConstant(stiffness);
      if (std::isinf(mu) && z.x() <= 0.0) D_[i](0, 0) = 0.0;
    } else if (mode == Mode::slide) {
      const Vec2 t = slide_direction(z, mu);
      D_[i](0, 0) = stiffness;
      D_[i].block<2, 1>(1, 0) = mu * stiffness * t;
      D_[i].block<2, 2>(1, 1) =
          slide_ratio(z, mu) * stiffness * (Eigen::Matrix2d::Identity() - t * t.transpose());
    }
    if (mode != Mode::open || std::isinf(mu)) problem.add_impulse(i, p_[i], F_);
  }
  return F_.norm();
}

void NewtonSolver::approach(const ConeProblem& problem, ConeSolution& solution) {
  const auto frictionless = [](double mu) { return mu == 0.0 || std::isinf(mu); };
  const bool symmetric =
      std::all_of(problem.friction.begin(), problem.friction.end(), frictionless);
  const double scale = problem.y_free.norm();
  double softness = softest;
  for (int i = 0; i < compliances; ++i, softness /= 10.0) {
    const double enough = scale * (softness > 5.0 ? 1e-3 : 1e-7);
    double error = evaluate(problem, softness, solution.y);
    for (int k = 0; k < steps_per_compliance && error > enough; ++k) {
      step_ = F_;
      ++solution.iterations;
      if (!system_.factorise(problem, D_, symmetric) || !system_.solve(step_)) break;
      double length = 1.0;
      double trial_error = 0.0;
      for (;; length *= 0.5) {
        trial_ = solution.y + length * step_;
        trial_error = evaluate(problem, softness, trial_);
        if (trial_error <= (1.0 - 1e-4 * length) * error || length < 1e-3) break;
      }
      solution.y = trial_;
      error = trial_error;
    }
  }
  solution.p = p_;
}

bool NewtonSolver::polish_twice(const ConeProblem& problem, double limit, int max_iterations,
                                ConeSolution& solution) {
  reference_.assign(problem.size(), Vec3::Zero());
  bool converged = polish(problem, limit, 1, max_iterations, solution);
  if (converged) {
    reference_ = solution.p;
    converged = polish(problem, limit, 0, max_iterations, solution);
  }
  solution.residual = natural_map_residual(problem, solution.p, solution.y);
  return converged;
}

// Per contact z = p - rho (c + R (p - reference)), rho = 1 / inertness, and p = P(z) is wanted. To
// first order
//   dp = K (P(z) - p) - rho K P'(z) J dy,  K = (1 - (1 - rho R) P'(z))^-1,
// which leaves (1 + J' rho K P'(z) J) dy = y_free + J' p - y + J' K (P(z) - p).
bool NewtonSolver::polish(const ConeProblem& problem, double limit, int least_iterations,
                          int max_iterations, ConeSolution& solution) {
  for (int iteration = 0;; ++iteration) {
    F_ = velocities_of(problem, solution.p) - solution.y;
    solution.y += F_;
    F_.setZero();
    double worst = 0.0;
    bool symmetric = true;
    for (std::size_t i = 0; i < problem.size(); ++i) {
      const double mu = problem.friction[i];
      const double R = softness_ * problem.compliance[i];
      const double rho = 1.0 / inertness_[i];
      const Vec3& p = solution.p[i];
      const Vec3 slack = problem.velocity(i, solution.y) + R * (p - reference_[i]);
      const Vec3 z = p - rho * slack;
      D_[i].setZero();
      const Mode mode = mode_of(z, mu);
      if (mode == Mode::open) {
        defect_[i] = -p;
        p_[i] = -p;
      } else if (mode == Mode::stick) {
        defect_[i] = -rho * slack;
        p_[i] = -slack / R;
        D_[i].diagonal().setConstant(1.0 / R);
        if (std::isinf(mu) && z.x() <= 0.0) {
          defect_[i].x() = -p.x();
          p_[i].x() = -p.x();
          D_[i](0, 0) = 0.0;
        }
      } else {
        const Vec2 t = slide_direction(z, mu);
        const double s = 1.0 - rho * R;
        const double m = slide_ratio(z, mu);
        const Eigen::Matrix2d across = Eigen::Matrix2d::Identity() - t * t.transpose();
        const Eigen::Matrix2d B = t * t.transpose() + across / (1.0 - s * m);
        const Vec2 slip_defect = mu * z.x() * t - p.tail<2>();
        defect_[i] << -rho * slack.x(), slip_defect;
        p_[i] << -slack.x() / R, -(s * mu * slack.x() / R) * t + B * slip_defect;
        D_[i](0, 0) = 1.0 / R;
        D_[i].block<2, 1>(1, 0) = mu / R * t;
        D_[i].block<2, 2>(1, 1) = rho * m / (1.0 - s * m) * across;
        symmetric = symmetric && mu == 0.0;
      }
      worst = std::max(worst, defect_[i].norm() * inertness_[i]);
      problem.add_impulse(i, p_[i], F_);
    }
    // At least one step from a guess: its shares may be uneven although its velocities are right.
    solution.converged = worst <= limit && iteration >= least_iterations;
    if (solution.converged || iteration == max_iterations) return solution.converged;

    ++solution.iterations;
    if (!system_.factorise(problem, D_, symmetric) || !system_.solve(F_)) return false;
    for (std::size_t i = 0; i < problem.size(); ++i) {
      Vec3 motion = Vec3::Zero();
      for (std::uint32_t k = problem.first[i]; k < problem.first[i + 1]; ++k) {
        motion +=
            problem.couplings[k].J * F_.segment<6>(Eigen::Index{6} * problem.couplings[k].block);
      }
      solution.p[i] += p_[i] - D_[i] * motion;
    }
    solution.y += F_;
  }
}

}  // namespace gotai::impulse
