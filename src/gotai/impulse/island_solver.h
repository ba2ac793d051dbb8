/// @file
/// Solves the contact problems of all islands of a step.
#pragma once

#include <vector>

#include "gotai/impulse/assembly.h"
#include "gotai/impulse/cone_problem.h"
#include "gotai/impulse/islands.h"
#include "gotai/model/contact_memory.h"
#include "gotai/model/settings.h"
#include "gotai/model/step.h"

namespace gotai::impulse {

/// Exact for problems up to this many bodies when solver = "auto".
inline constexpr std::size_t exact_up_to_bodies = 64;

/// What the settings' solver means for a problem: "auto" chooses by size.
bool uses_exact_solver(const ConeProblem& problem, const model::ImpulseSettings& settings);

/// Solves one problem with the solver, tolerance and iterations that the settings name.
/// @param guess  impulses to start from, or nothing
void solve_by_settings(const ConeProblem& problem, const std::vector<Vec3>* guess,
                       const model::ImpulseSettings& settings, ConeSolution& solution);

/// Islands, their problems and solutions; keeps storage from step to step.
class IslandSolver {
 public:
  explicit IslandSolver(const model::Settings& settings) : settings_(settings) {}

  /// Finds the islands and recalls the impulses of the last step.
  /// @param contacts  must live until solve() is done
  void prepare(const model::BodyState& bodies, const model::ContactSet& contacts,
               const model::ContactMemory& memory);
  /// Assembles and solves every island and adds the impulses to the update.
  /// @param bodies  velocities with gravity
  /// @param gap     per contact [m]
  void solve(const model::BodyState& bodies, const ContactTargets& targets,
             const std::vector<double>& gap, double dt, model::Update& update);
  const model::SolveReport& report() const { return report_; }

 private:
  /// Storage for one island.
  struct Work {
    ConeProblem problem;
    std::vector<Mat3> frame;  // contact frames, W
    std::vector<Vec3> guess;  // contact frames [N s]
    ConeSolution solution;
    bool plastic = false;  // solved without restitution
  };

  void solve_island(const model::BodyState& bodies, const Island& island,
                    const ContactTargets& targets, const std::vector<double>& gap, double dt,
                    Work& work) const;
  void solve_plastic(const model::BodyState& bodies, const Island& island, ContactTargets targets,
                     const std::vector<double>& gap, double dt, Work& work) const;

  model::Settings settings_;
  const model::ContactSet* contacts_ = nullptr;
  std::vector<Vec3> warm_impulse_;  // per contact, of the last step [N s], W
  std::vector<Island> islands_;
  std::vector<Work> work_;  // per island
  model::SolveReport report_;
};

}  // namespace gotai::impulse
