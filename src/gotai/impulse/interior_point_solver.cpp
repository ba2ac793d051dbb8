#include "gotai/impulse/interior_point_solver.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace gotai::impulse {
namespace {

constexpr int most_iterations = 120;
constexpr int patience = 8;  // iterations without a better residual
constexpr int most_restarts = 2;
constexpr double restart_distance = 1e-3;  // from the boundary, of the first start's
constexpr double near_distance = 1e-2;     // the same when starting near a given point
constexpr double worth_polishing = 1e-7;   // residual / velocity scale: polishing does the rest
constexpr double towards_boundary = 0.9;   // of the longest step; more after a long step
constexpr double towards_boundary_fast = 0.99;
constexpr double long_step = 0.7;
constexpr double short_step = 0.1;  // after it, only centring

// x_N^2 - |x_T|^2, positive inside L.
double determinant(const Vec3& x) {
  const double tangential = std::hypot(x.y(), x.z());
  return (x.x() - tangential) * (x.x() + tangential);
}

Vec3 jordan_product(const Vec3& a, const Vec3& b) {
  return {a.dot(b), a.x() * b.y() + b.x() * a.y(), a.x() * b.z() + b.x() * a.z()};
}

// x with jordan_product(a, x) = b.
Vec3 jordan_quotient(const Vec3& a, const Vec3& b) {
  const double x = (a.x() * b.x() - a.y() * b.y() - a.z() * b.z()) / determinant(a);
  return {x, (b.y() - x * a.y()) / a.x(), (b.z() - x * a.z()) / a.x()};
}

Vec3 reflected(const Vec3& x) { return {x.x(), -x.y(), -x.z()}; }

// Largest t with x + t d in L, for x inside.
double step_to_boundary(const Vec3& x, const Vec3& d) {
  const double a = d.dot(reflected(d));
  const double b = x.dot(reflected(d));
  const double c = determinant(x);
  double t = d.x() < 0.0 ? -x.x() / d.x() : std::numeric_limits<double>::infinity();
  const double discriminant = b * b - a * c;
  if (discriminant < 0.0 || (a >= 0.0 && b >= 0.0)) return t;
  // Roots of a t^2 + 2 b t + c without cancellation.
  const double q = b <= 0.0 ? -b + std::sqrt(discriminant) : -b - std::sqrt(discriminant);
  for (const double root : {a != 0.0 ? q / a : -1.0, q != 0.0 ? c / q : -1.0}) {
    if (root > 0.0) t = std::min(t, root);
  }
  return t;
}

}  // namespace

bool InteriorPointSolver::suits(const ConeProblem& problem) {
  return std::all_of(problem.friction.begin(), problem.friction.end(),
                     [](double mu) { return std::isfinite(mu); });
}

void InteriorPointSolver::start(const ConeProblem& problem) {
  system_.analyse(problem);
  const std::size_t n = problem.size();
  contacts_.resize(n);
  D_.resize(n);
  p_.resize(n);
  y_ = problem.y_free;
  const double scale = velocity_scale(problem);
  for (std::size_t i = 0; i < n; ++i) {
    const double mu = problem.friction[i];
    contacts_[i].scale = Vec3(1.0, mu, mu);
    contacts_[i].s = Vec3(scale, 0.0, 0.0);
    contacts_[i].z = Vec3(scale / problem.inertness(i), 0.0, 0.0);
  }
}

// A point of the boundary, moved inwards.
void InteriorPointSolver::start_near(const ConeProblem& problem, double distance,
                                     const ConeSolution& point) {
  const double scale = distance * velocity_scale(problem);
  y_ = point.y;
  for (std::size_t i = 0; i < problem.size(); ++i) {
    Contact& contact = contacts_[i];
    const Vec3 target = contact.scale.cwiseProduct(problem.velocity(i, y_));
    const double slip = std::hypot(target.y(), target.z());
    contact.s << std::max(0.0, target.x()) + slip + scale, target.y(), target.z();
    contact.z = point.p[i];
    if (problem.friction[i] > 0.0) contact.z.tail<2>() /= problem.friction[i];
    contact.z.x() += scale / problem.inertness(i);
  }
}

// Defects at the present point; returns the mean of s . z.
double InteriorPointSolver::measure(const ConeProblem& problem) {
  dual_defect_ = problem.y_free - y_;
  double sum = 0.0;
  for (std::size_t i = 0; i < problem.size(); ++i) {
    Contact& contact = contacts_[i];
    p_[i] = contact.scale.cwiseProduct(contact.z);
    problem.add_impulse(i, p_[i], dual_defect_);
    Vec3 target =
        contact.scale.cwiseProduct(problem.velocity(i, y_) + problem.compliance[i] * p_[i]);
    const double slip = std::hypot(target.y(), target.z());
    contact.slip.setZero();
    if (slip > 0.0) contact.slip.tail<2>() = target.tail<2>() / slip;
    target.x() += slip;
    contact.defect = contact.s - target;
    sum += contact.s.dot(contact.z);
  }
  return sum / static_cast<double>(problem.size());
}

// Nesterov-Todd scaling: the symmetric W with W z = W^-1 s.
void InteriorPointSolver::scale_contacts() {
  for (Contact& contact : contacts_) {
    const double root_s = std::sqrt(determinant(contact.s));
    const double root_z = std::sqrt(determinant(contact.z));
    const Vec3 s = contact.s / root_s;
    const Vec3 z = contact.z / root_z;
    const double gamma = std::sqrt(0.5 * (1.0 + s.dot(z)));
    Vec3 v = (s + reflected(z)) / (2.0 * gamma);
    v.x() += 1.0;
    v /= std::sqrt(2.0 * v.x());
    const double beta = std::sqrt(root_s / root_z);
    const Mat3 J = Vec3(1.0, -1.0, -1.0).asDiagonal();
    contact.W = beta * (2.0 * v * v.transpose() - J);
    contact.W_inverse = (2.0 * reflected(v) * reflected(v).transpose() - J) / beta;
    contact.lambda = contact.W * contact.z;
  }
}

// ds = G dy + C dz - defect with G = E T J, E = 1 + e_N slip', C = E T R T, and
// W dz + W^-1 ds = r leave dz = (1 + W^-2 C)^-1 (W^-1 r - W^-2 (G dy - defect)).
bool InteriorPointSolver::factorise(const ConeProblem& problem) {
  for (std::size_t i = 0; i < problem.size(); ++i) {
    Contact& contact = contacts_[i];
    const Mat3 inverse = contact.W_inverse * contact.W_inverse;
    const Mat3 T = contact.scale.asDiagonal();
    Mat3 ET = T;
    ET.row(0) += contact.slip.transpose() * T;
    const Mat3 C = problem.compliance[i] * ET * T;
    contact.K = (Mat3::Identity() + inverse * C).inverse();
    D_[i] = T * contact.K * inverse * ET;
  }
  return system_.factorise(problem, D_, false);
}

// The step for lambda o (W dz + W^-1 ds) = target e - lambda o lambda [- the last step's product].
bool InteriorPointSolver::step_to(const ConeProblem& problem, double target, bool correct) {
  dy_ = dual_defect_;
  for (std::size_t i = 0; i < problem.size(); ++i) {
    Contact& contact = contacts_[i];
    Vec3 r = Vec3(target, 0.0, 0.0) - jordan_product(contact.lambda, contact.lambda);
    if (correct) {
      r -= jordan_product(contact.W_inverse * contact.ds, contact.W * contact.dz);
    }
    contact.rest = contact.K * (contact.W_inverse * (jordan_quotient(contact.lambda, r) +
                                                     contact.W_inverse * contact.defect));
    problem.add_impulse(i, contact.scale.cwiseProduct(contact.rest), dy_);
  }
  if (!system_.solve(dy_)) return false;
  for (std::size_t i = 0; i < problem.size(); ++i) {
    Contact& contact = contacts_[i];
    Vec3 motion = contact.scale.cwiseProduct(problem.velocity(i, dy_) - problem.bias[i]);
    motion.x() += contact.slip.dot(motion);
    contact.dz = contact.rest - contact.K * (contact.W_inverse * (contact.W_inverse * motion));
    Vec3 yielded =
        problem.compliance[i] * contact.scale.cwiseProduct(contact.scale).cwiseProduct(contact.dz);
    yielded.x() += contact.slip.dot(yielded);
    contact.ds = motion + yielded - contact.defect;
  }
  return true;
}

double InteriorPointSolver::longest_step() const {
  double longest = std::numeric_limits<double>::infinity();
  for (const Contact& contact : contacts_) {
    longest = std::min({longest, step_to_boundary(contact.s, contact.ds),
                        step_to_boundary(contact.z, contact.dz)});
  }
  return longest;
}

void InteriorPointSolver::keep_best(const ConeProblem& problem, int iteration,
                                    ConeSolution& solution) {
  const Eigen::VectorXd y = velocities_of(problem, p_);
  const double residual = natural_map_residual(problem, p_, y);
  if (!(residual < solution.residual)) return;
  solution.p = p_;
  solution.y = y;
  solution.residual = residual;
  best_iteration_ = iteration;
}

void InteriorPointSolver::solve(const ConeProblem& problem, const ConeSolution* near, double limit,
                                ConeSolution& solution) {
  start(problem);
  if (near != nullptr) start_near(problem, near_distance, *near);
  const double enough = std::max(limit, worth_polishing * velocity_scale(problem));
  solution.residual = std::numeric_limits<double>::infinity();
  best_iteration_ = 0;
  double last_length = 1.0;
  bool stuck = false;  // the last step failed
  int restarts = 0;
  for (solution.iterations = 0; solution.iterations < most_iterations; ++solution.iterations) {
    const double gap = measure(problem);
    keep_best(problem, solution.iterations, solution);
    if (solution.residual <= enough) break;
    if (stuck || solution.iterations - best_iteration_ > patience) {
      if (restarts++ == most_restarts) break;
      // Where the path folds or hugs the boundary, the best point so far may lead on.
      start_near(problem, std::pow(restart_distance, restarts), solution);
      best_iteration_ = solution.iterations;
      last_length = 1.0;
      stuck = false;
      continue;
    }
    stuck = true;
    scale_contacts();
    if (!factorise(problem) || !step_to(problem, 0.0, false)) continue;
    const bool only_centre = last_length < short_step;
    const double remains = 1.0 - std::min(1.0, longest_step());
    const double centring = only_centre ? 1.0 : std::max(1e-6, remains * remains * remains);
    if (!step_to(problem, centring * gap, !only_centre)) continue;
    const double fraction = last_length > long_step ? towards_boundary_fast : towards_boundary;
    last_length = std::min(1.0, fraction * longest_step());
    stuck = !(last_length > 0.0);
    if (stuck) continue;
    y_ += last_length * dy_;
    for (Contact& contact : contacts_) {
      contact.s += last_length * contact.ds;
      contact.z += last_length * contact.dz;
    }
  }
  solution.converged = solution.residual <= limit;
}

}  // namespace gotai::impulse
