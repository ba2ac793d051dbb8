#include "gotai/impulse/cone_problem.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace gotai::impulse {

void ConeProblem::clear() {
  blocks = 0;
  first.assign(1, 0);
  couplings.clear();
  bias.clear();
  friction.clear();
  compliance.clear();
  patch.clear();
}

double ConeProblem::inertness(std::size_t i) const {
  double sum = 0.0;
  for (std::uint32_t k = first[i]; k < first[i + 1]; ++k) {
    // A frictionless contact moves along its normal only; its tangent rows may be empty.
    sum += friction[i] > 0.0 ? couplings[k].J.squaredNorm() / 3.0
                             : couplings[k].J.row(0).squaredNorm();
  }
  return sum;
}

void set_compliance(ConeProblem& problem, const std::vector<double>& area, double ridge) {
  assert(area.size() == problem.size());
  const std::size_t n = problem.size();
  double trace = 0.0;
  for (const Coupling& coupling : problem.couplings) trace += coupling.J.row(0).squaredNorm();
  double total_area = 0.0;
  for (const double a : area) total_area += a;
  const double scale = n == 0 ? 0.0 : ridge * trace / static_cast<double>(n);
  const double mean_area = n == 0 ? 0.0 : total_area / static_cast<double>(n);
  problem.compliance.resize(n);
  for (std::size_t i = 0; i < n; ++i) problem.compliance[i] = scale * mean_area / area[i];
}

Vec3 project_on_friction(const Vec3& z, double friction) {
  const double normal = std::max(0.0, z.x());
  if (std::isinf(friction)) return {normal, z.y(), z.z()};
  const double limit = friction * normal;
  const double tangential = std::sqrt(z.y() * z.y() + z.z() * z.z());
  if (tangential <= limit) return {normal, z.y(), z.z()};
  const double scale = limit / tangential;
  return {normal, scale * z.y(), scale * z.z()};
}

double natural_map_residual(const ConeProblem& problem, std::size_t i, const Vec3& p,
                            const Eigen::VectorXd& y) {
  const double inertness = problem.inertness(i);
  const Vec3 z = p - problem.velocity(i, y) / inertness;
  return (p - project_on_friction(z, problem.friction[i])).norm() * inertness;
}

double natural_map_residual(const ConeProblem& problem, const std::vector<Vec3>& p,
                            const Eigen::VectorXd& y) {
  double worst = 0.0;
  for (std::size_t i = 0; i < problem.size(); ++i) {
    worst = std::max(worst, natural_map_residual(problem, i, p[i], y));
  }
  return worst;
}

Eigen::VectorXd velocities_of(const ConeProblem& problem, const std::vector<Vec3>& p) {
  Eigen::VectorXd y = problem.y_free;
  for (std::size_t i = 0; i < problem.size(); ++i) problem.add_impulse(i, p[i], y);
  return y;
}

double velocity_scale(const ConeProblem& problem) {
  double scale = 0.0;
  for (std::size_t i = 0; i < problem.size(); ++i) {
    scale = std::max(scale, problem.velocity(i, problem.y_free).norm());
  }
  return scale;
}

}  // namespace gotai::impulse
