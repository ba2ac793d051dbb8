/// @file
/// What the plans of several methods have in common.
#pragma once

#include "gotai/model/body_state.h"
#include "gotai/model/settings.h"
#include "gotai/model/step.h"

namespace gotai::impulse {

/// One solve for the whole step of dt [s], in the order that the settings' integrator names.
model::StepPlan whole_step(const model::Settings& settings, double dt);

/// Gap that two surface points can close in a step of dt [s], with gravity [m].
double approach_margin(const model::BodyState& bodies, const Vec3& gravity, double dt);

}  // namespace gotai::impulse
