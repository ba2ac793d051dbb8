#include "gotai/core/error.h"
#include "gotai/impulse/apparent_method.h"
#include "gotai/impulse/constraint_method.h"
#include "gotai/impulse/impulse_method.h"
#include "gotai/impulse/method.h"
#include "gotai/impulse/penalty_method.h"
#include "gotai/impulse/sem_method.h"
#include "gotai/impulse/substepped.h"
#include "gotai/impulse/vector_field_method.h"

namespace gotai::impulse {
namespace {

// The constraint method: apparent contacts, the sub-stepped solver for surface contacts unless
// another is named, else all contacts at once.
std::unique_ptr<ImpulseMethod> make_constraint_method(const model::Settings& settings) {
  using model::ContactTreatment;
  using model::SolverName;
  const model::ImpulseSettings& impulse = settings.impulse;
  const ContactTreatment contacts = model::contact_treatment(settings);
  if (contacts == ContactTreatment::apparent) return std::make_unique<ApparentMethod>(settings);
  const bool suits_substeps = contacts == ContactTreatment::reduced ||
                              settings.collision.model == model::CollisionModel::surface;
  if (impulse.solver == SolverName::substepped ||
      (impulse.solver == SolverName::automatic && suits_substeps))
    return std::make_unique<SubsteppedConstraint>(settings);
  return std::make_unique<ConstraintMethod>(settings);
}

}  // namespace

std::unique_ptr<ImpulseMethod> make_method(const model::Settings& settings) {
  using model::ImpulseMethodName;
  const model::ImpulseSettings& impulse = settings.impulse;
  if (impulse.method != ImpulseMethodName::constraint &&
      impulse.contacts == model::ContactTreatment::apparent) {
    throw InvalidArgument("impulse.contacts", to_string(impulse.contacts),
                          "is chapter 5's simplification of the constraint method: use it with "
                          "impulse.method = \"constraint\"");
  }
  switch (impulse.method) {
    case ImpulseMethodName::constraint:
      return make_constraint_method(settings);
    case ImpulseMethodName::penalty:
      return std::make_unique<PenaltyMethod>(settings);
    case ImpulseMethodName::impulse:
      return std::make_unique<SuperposedImpulses>(settings, false);
    case ImpulseMethodName::impulse_averaged:
      return std::make_unique<SuperposedImpulses>(settings, true);
    case ImpulseMethodName::sem:
      return std::make_unique<SemMethod>(settings);
    case ImpulseMethodName::vector_field:
      return std::make_unique<VectorFieldMethod>(settings);
  }
  throw InvalidArgument("impulse.method", to_string(impulse.method), "is not a method");
}

}  // namespace gotai::impulse
