#include "gotai/core/error.h"
#include "gotai/impulse/constraint_method.h"
#include "gotai/impulse/method.h"

namespace gotai::impulse {

std::unique_ptr<ImpulseMethod> make_method(const model::Settings& settings) {
  const model::ImpulseSettings& impulse = settings.impulse;
  if (impulse.contacts != model::ContactTreatment::all) {
    throw InvalidArgument("impulse.contacts", to_string(impulse.contacts), "must be \"all\"");
  }
  if (impulse.method != model::ImpulseMethodName::constraint) {
    throw InvalidArgument("impulse.method", to_string(impulse.method), "must be \"constraint\"");
  }
  return std::make_unique<ConstraintMethod>(settings);
}

}  // namespace gotai::impulse
