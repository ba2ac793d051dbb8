#include "thesis/contact_example.h"

#include <algorithm>

#include "gotai/impulse/exact_solver.h"

namespace gotai::experiments {

ContactAnswer solve_example(const ContactExample& example) {
  impulse::ConeProblem problem;
  problem.blocks = 1;
  problem.y_free = Eigen::VectorXd::Zero(6);
  problem.first = {0};
  for (std::size_t i = 0; i < example.arm.size(); ++i) {
    impulse::Coupling coupling;
    coupling.J.setZero();
    coupling.J(0, 2) = 1.0;              // up
    coupling.J(0, 4) = -example.arm[i];  // about y
    coupling.J(1, 0) = 1.0;
    coupling.J(2, 1) = 1.0;
    problem.couplings.push_back(coupling);
    problem.first.push_back(static_cast<std::uint32_t>(problem.couplings.size()));
    const double target = example.v[i] + example.restitution * std::min(example.v[i], 0.0);
    problem.bias.emplace_back(target, 0.0, 0.0);
    problem.friction.push_back(0.0);
  }
  problem.patch = {0, static_cast<std::uint32_t>(example.arm.size())};
  impulse::set_compliance(problem, std::vector<double>(example.arm.size(), 1.0), 1e-9);
  impulse::ConeSolution solution;
  impulse::solve_exact(problem, nullptr, 1e-13, solution);
  ContactAnswer answer;
  for (std::size_t i = 0; i < example.arm.size(); ++i) {
    answer.p.push_back(solution.p[i].x());
    answer.v.push_back(example.v[i] + problem.couplings[i].J.row(0).dot(solution.y));
  }
  return answer;
}

}  // namespace gotai::experiments
