#include "gotai/model/settings.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include "gotai/core/error.h"

namespace gotai::model {
namespace {

template <typename Enum>
using Names = std::span<const std::pair<Enum, std::string_view>>;

constexpr std::array<std::pair<CollisionModel, std::string_view>, 2> kModels{
    {{CollisionModel::spheres, "spheres"}, {CollisionModel::surface, "surface"}}};
constexpr std::array<std::pair<ImpulseMethodName, std::string_view>, 6> kMethods{
    {{ImpulseMethodName::penalty, "penalty"},
     {ImpulseMethodName::impulse, "impulse"},
     {ImpulseMethodName::impulse_averaged, "impulse-averaged"},
     {ImpulseMethodName::constraint, "constraint"},
     {ImpulseMethodName::sem, "sem"},
     {ImpulseMethodName::vector_field, "vector-field"}}};
constexpr std::array<std::pair<ContactTreatment, std::string_view>, 4> kTreatments{
    {{ContactTreatment::automatic, "auto"},
     {ContactTreatment::all, "all"},
     {ContactTreatment::apparent, "apparent"},
     {ContactTreatment::reduced, "reduced"}}};
constexpr std::array<std::pair<SolverName, std::string_view>, 4> kSolvers{
    {{SolverName::automatic, "auto"},
     {SolverName::exact, "exact"},
     {SolverName::iterative, "iterative"},
     {SolverName::substepped, "substepped"}}};
constexpr std::array<std::pair<Integrator, std::string_view>, 2> kIntegrators{
    {{Integrator::semi_implicit, "semi-implicit"}, {Integrator::explicit_euler, "explicit-euler"}}};

template <typename Enum>
std::string_view name_of(Names<Enum> names, Enum value) {
  for (const auto& [candidate, name] : names)
    if (candidate == value) return name;
  return "?";
}

template <typename Enum>
Enum parse(Names<Enum> names, std::string_view setting, std::string_view text) {
  std::string allowed;
  for (const auto& [value, name] : names) {
    if (name == text) return value;
    allowed += allowed.empty() ? "" : ", ";
    allowed += name;
  }
  throw InvalidArgument(setting, "\"" + std::string(text) + "\"", "must be one of " + allowed);
}

void require(bool ok, std::string_view name, double value, std::string_view reason) {
  if (!ok) throw InvalidArgument(name, fmt::format("{:g}", value), reason);
}

}  // namespace

ContactTreatment contact_treatment(const Settings& settings) {
  if (settings.impulse.contacts != ContactTreatment::automatic) return settings.impulse.contacts;
  const bool few = settings.collision.model == CollisionModel::surface &&
                   settings.impulse.method == ImpulseMethodName::constraint;
  return few ? ContactTreatment::reduced : ContactTreatment::all;
}

std::string_view to_string(CollisionModel v) { return name_of<CollisionModel>(kModels, v); }
std::string_view to_string(ImpulseMethodName v) { return name_of<ImpulseMethodName>(kMethods, v); }
std::string_view to_string(ContactTreatment v) { return name_of<ContactTreatment>(kTreatments, v); }
std::string_view to_string(SolverName v) { return name_of<SolverName>(kSolvers, v); }
std::string_view to_string(Integrator v) { return name_of<Integrator>(kIntegrators, v); }

CollisionModel parse_collision_model(std::string_view text) {
  return parse<CollisionModel>(kModels, "collision.model", text);
}
ImpulseMethodName parse_impulse_method(std::string_view text) {
  return parse<ImpulseMethodName>(kMethods, "impulse.method", text);
}
ContactTreatment parse_contact_treatment(std::string_view text) {
  return parse<ContactTreatment>(kTreatments, "impulse.contacts", text);
}
SolverName parse_solver(std::string_view text) {
  return parse<SolverName>(kSolvers, "impulse.solver", text);
}
Integrator parse_integrator(std::string_view text) {
  return parse<Integrator>(kIntegrators, "time.integrator", text);
}

void validate(const Settings& s) {
  require(s.gravity.allFinite(), "world.gravity", s.gravity.norm(), "must be finite [m/s^2]");
  require(s.collision.level >= 1 && s.collision.level <= 9, "collision.level", s.collision.level,
          "must be in 1..9");
  require(s.impulse.ridge >= 0.0 && s.impulse.ridge < 1e-2, "impulse.ridge", s.impulse.ridge,
          "must be in [0, 0.01)");
  require(s.impulse.tolerance > 0.0 && s.impulse.tolerance < 1.0, "impulse.tolerance",
          s.impulse.tolerance, "must be in (0, 1)");
  require(s.impulse.max_iterations >= 1, "impulse.max_iterations", s.impulse.max_iterations,
          "must be >= 1");
  require(
      s.impulse.penetration >= kLeastPenetration && s.impulse.penetration <= kLargestPenetration,
      "impulse.penetration", s.impulse.penetration,
      "must be in [1e-6, 0.5], a fraction of the smallest bounding radius");
  require(s.impulse.rolling_resistance >= 0.0 && s.impulse.rolling_resistance <= 1.0,
          "impulse.rolling_resistance", s.impulse.rolling_resistance,
          "must be in [0, 1], a fraction of the smaller body's bounding radius");
  require(s.time.step >= 0.0 && std::isfinite(s.time.step), "time.step", s.time.step,
          "must be positive [s], or \"auto\"");
  require(s.time.safety > 0.0 && s.time.safety <= 1.0, "time.safety", s.time.safety,
          "must be in (0, 1]");
  require(s.time.max_step > 0.0 && std::isfinite(s.time.max_step), "time.max_step", s.time.max_step,
          "must be positive [s]");
}

}  // namespace gotai::model
