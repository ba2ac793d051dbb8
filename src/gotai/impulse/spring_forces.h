/// @file
/// Springs and dampers at contacts: what the penalty method and the vector field share.
#pragma once

#include <vector>

#include "gotai/impulse/patch_friction.h"
#include "gotai/model/body_state.h"
#include "gotai/model/contact_set.h"
#include "gotai/model/material.h"
#include "gotai/model/step.h"

namespace gotai::impulse {

/// Damping ratio of a spring that returns the fraction e of the approach speed (2.2):
/// e = exp(-pi zeta / sqrt(1 - zeta^2)); 1 (critical) for e = 0.
double damping_ratio(double restitution);

/// 1 / (1/m_A + 1/m_B) [kg].
double reduced_mass(const model::BodyState& bodies, const model::ContactPair& pair);

/// Largest ratio of a contact's effective inverse mass to that of the centre of mass over all
/// dynamic bodies, >= 1: how much faster than expected a spring at the rim swings.
double largest_leverage(const model::BodyState& bodies);

/// One pair's normal springs, all contacts together; each of its n active contacts takes 1/n.
struct PairSpring {
  double frequency = 0.0;      ///< undamped angular frequency on the reduced mass [rad/s]
  double rest_gap = 0.0;       ///< gap at which the spring is relaxed [m]
  double damping_ratio = 0.0;  ///< of critical
  double friction = 0.0;       ///< mu
  bool tension = false;        ///< the force may pull while the spring is compressed
};

/// Adds the impulses of one pair's springs over a sub-step, then friction.
/// @param gap   per contact of the set [m]
/// @param step  [s]
/// @param[in,out] velocities   of the bodies; other pairs' springs must read `before`
/// @param before  velocities at the start of the sub-step
/// @param[out] normal_impulse  per contact [N s]
/// @param[in,out] contact_impulse  per contact, on body A, world frame [N s]
/// @return number of active contacts
std::uint32_t add_spring_impulses(const model::BodyState& bodies, const model::ContactSet& contacts,
                                  const model::ContactPair& pair, const PairSpring& spring,
                                  const std::vector<double>& gap, double step,
                                  const WorkingVelocities& before, WorkingVelocities& velocities,
                                  std::vector<double>& normal_impulse,
                                  std::vector<Vec3>& contact_impulse);

/// The springs of all pairs over a step: one entry per pair, and storage kept from step to step.
class Springs {
 public:
  /// Fits a spring to every pair.
  /// @param contacts  must live until the last solve()
  /// @param fit       pair, surface -> PairSpring
  template <typename Fit>
  void prepare(const model::BodyState& bodies, const model::ContactSet& contacts,
               const model::MaterialTable& materials, const model::StepPlan& plan, const Fit& fit) {
    start(contacts, plan);
    for (const model::ContactPair& pair : contacts.pairs) {
      const model::SurfacePair surface =
          materials.combine(bodies.material[pair.body_a], bodies.material[pair.body_b]);
      PairSpring spring = fit(pair);
      spring.damping_ratio = damping_ratio(surface.restitution);
      spring.friction = surface.friction;
      springs_.push_back(spring);
    }
  }

  /// Adds the impulses of a sub-step, all springs read at its start.
  /// @param gap  per contact [m]
  void solve(const model::BodyState& bodies, const std::vector<double>& gap, model::Update& update);

  /// Sub-steps, and the largest number of contacts that acted in one.
  const model::SolveReport& report() const { return report_; }

 private:
  void start(const model::ContactSet& contacts, const model::StepPlan& plan);

  const model::ContactSet* contacts_ = nullptr;  // of the step
  std::vector<PairSpring> springs_;              // per pair
  double substep_ = 0.0;                         // [s]
  WorkingVelocities before_;
  WorkingVelocities velocities_;
  std::vector<double> normal_impulse_;  // per contact [N s]
  model::SolveReport report_;
};

/// Sub-steps of a step of dt [s] in which the stiffest spring, at a body's rim, is followed
/// closely; one for a step of no time.
/// @param frequency  on the reduced mass [rad/s]
int substeps_for_springs(const model::BodyState& bodies, double frequency, double dt);

}  // namespace gotai::impulse
