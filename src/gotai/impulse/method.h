/// @file
/// The interface of every impulse method: one implementation per method of the thesis.
#pragma once

#include <memory>

#include "gotai/model/body_state.h"
#include "gotai/model/contact_memory.h"
#include "gotai/model/contact_set.h"
#include "gotai/model/material.h"
#include "gotai/model/settings.h"
#include "gotai/model/step.h"

namespace gotai::impulse {

/// Turns contacts into impulses. One object lives as long as its world; it keeps storage between
/// steps but no state that changes results (that is ContactMemory). A step calls
///   plan, prepare, then per sub-step solve (and relax), then finish.
class ImpulseMethod {
 public:
  virtual ~ImpulseMethod() = default;

  /// How this method wants a step of dt [s] to be run: contact margin, sub-steps, order.
  virtual model::StepPlan plan(const model::BodyState& bodies, double dt) const = 0;

  /// Sets up the problem of the step.
  /// @param bodies    velocities before gravity (V of Makino 2007, eq. 4.15)
  /// @param contacts  must live until finish()
  /// @param memory    impulses of the last step, for warm starts
  virtual void prepare(const model::BodyState& bodies, const model::ContactSet& contacts,
                       const model::MaterialTable& materials, const model::StepPlan& plan,
                       const model::ContactMemory& memory) = 0;

  /// Computes velocity changes for one sub-step.
  /// @param bodies       velocities with gravity applied (V*); before it when plan.positions_first
  /// @param gap          current gap per contact [m] (refreshed when the plan asks for it)
  /// @param[in,out] update  delta_* are written; contact_impulse is added to
  virtual void solve(const model::BodyState& bodies, const std::vector<double>& gap,
                     model::Update& update) = 0;

  /// The unbiased solve after poses have moved. Called when plan.relax.
  virtual void relax(const model::BodyState& /*bodies*/, model::Update& /*update*/) {}

  /// After the last sub-step: restitution, spreading back, and what to remember for the next step.
  virtual void finish(const model::BodyState& bodies, model::Update& update,
                      model::ContactMemory& memory) = 0;

  virtual model::SolveReport report() const = 0;
};

/// Makes the method that the settings name.
/// @throws InvalidArgument when the combination of method, contacts and solver makes no sense
std::unique_ptr<ImpulseMethod> make_method(const model::Settings& settings);

}  // namespace gotai::impulse
