/// @file
/// Measurements of a world that every step reports.
#pragma once

#include "gotai/model/body_state.h"
#include "gotai/model/contact_set.h"
#include "gotai/model/settings.h"
#include "gotai/model/step.h"

namespace gotai {

/// Energy of the dynamic bodies [J]. The correction term makes the total of the scheme exact in
/// free flight: + 1/2 h sum m g.v for semi-implicit Euler, - for explicit Euler.
/// @param h  size of the last sub-step [s]
model::Energy measure_energy(const model::BodyState& bodies, const model::Settings& settings,
                             double h);

/// Fills the contact figures of a report: pairs, contacts, overlaps.
void measure_contacts(const model::ContactSet& contacts, model::StepReport& report);

}  // namespace gotai
