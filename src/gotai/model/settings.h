/// @file
/// The settings of a world: one validated struct with the same names in C++, in scene files, in
/// recordings and on the command line (`--set impulse.method=penalty`).
#pragma once

#include <cstdint>
#include <string_view>

#include "gotai/core/types.h"

namespace gotai::model {

enum class CollisionModel : std::uint8_t { spheres, surface };
enum class ImpulseMethodName : std::uint8_t {
  penalty,
  impulse,
  impulse_averaged,
  constraint,
  sem,
  vector_field
};
/// Which contacts an impulse method reads: all that were found, chapter 5's one per pair, or few
/// per patch. Automatic: see contact_treatment().
enum class ContactTreatment : std::uint8_t { automatic, all, apparent, reduced };
/// How the constraint method solves. Automatic: sub-stepped for surface contacts; for spheres exact
/// or iterative by size.
enum class SolverName : std::uint8_t { automatic, exact, iterative, substepped };
enum class Integrator : std::uint8_t { semi_implicit, explicit_euler };

struct CollisionSettings {
  CollisionModel model = CollisionModel::surface;
  int level = 6;  ///< k of Fig. 3-5; at most the prepared level of every shape
};

/// Bounds of ImpulseSettings::penetration: stiffer springs take thousands of sub-steps, softer ones
/// hold nothing up.
inline constexpr double kLeastPenetration = 1e-6;
inline constexpr double kLargestPenetration = 0.5;

/// Rolling resistance of bodies that hardly turn, unless ImpulseSettings::rolling_resistance is 0.
inline constexpr double kRestingResistance = 2e-2;

struct ImpulseSettings {
  ImpulseMethodName method = ImpulseMethodName::constraint;
  ContactTreatment contacts = ContactTreatment::automatic;
  SolverName solver = SolverName::automatic;
  /// Compliance that shares the load of redundant contacts, as a fraction of trace(A)/n (erratum
  /// 23).
  double ridge = 1e-9;
  double tolerance = 1e-10;   ///< iterative solver: relative natural-map residual
  int max_iterations = 1000;  ///< iterative solver: sweeps per step
  /// Penalty method: how deep a body at rest may sink, as a fraction of the smallest dynamic body's
  /// bounding radius.
  double penetration = 1e-3;
  /// Penalty method: dampers may pull at the end of a contact, as (2.2) assumes (erratum 2).
  bool tension = false;
  /// Sub-stepped solver: resistance of bodies to rolling and spinning on each other, as a fraction
  /// of the smaller one's bounding radius: the arm of a torque that at most all that presses them
  /// has. Pairs that turn slower than gravity makes them in a step resist by kRestingResistance, if
  /// that is more, so that piles come to rest. 0: none at all. Other solvers and methods have none.
  double rolling_resistance = 1e-4;
};

struct TimeSettings {
  double step = 0.0;             ///< [s]; 0 means derived from level, speed and spin ("auto")
  double safety = 0.5;           ///< factor on the derived bound (errata 30, 44)
  double max_step = 1.0 / 60.0;  ///< [s], cap of the derived step
  Integrator integrator = Integrator::semi_implicit;
};

struct Settings {
  Vec3 gravity = Vec3(0.0, 0.0, -9.81);  ///< [m/s^2], W
  CollisionSettings collision;
  ImpulseSettings impulse;
  TimeSettings time;
};

/// The contacts that are read, after `automatic` is decided: few per patch for the constraint
/// method on surface contacts; all for the thesis's spheres and for the methods compared with it.
ContactTreatment contact_treatment(const Settings& settings);

/// Names as written in scene files ("impulse-averaged"). The parse functions are their inverse.
std::string_view to_string(CollisionModel value);
std::string_view to_string(ImpulseMethodName value);
std::string_view to_string(ContactTreatment value);
std::string_view to_string(SolverName value);
std::string_view to_string(Integrator value);
/// @throws InvalidArgument listing the allowed names
CollisionModel parse_collision_model(std::string_view text);
ImpulseMethodName parse_impulse_method(std::string_view text);
ContactTreatment parse_contact_treatment(std::string_view text);
SolverName parse_solver(std::string_view text);
Integrator parse_integrator(std::string_view text);

/// @throws InvalidArgument naming the setting as in a scene file, its value and what is allowed
void validate(const Settings& settings);

}  // namespace gotai::model
