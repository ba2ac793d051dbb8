/// @file
/// What passes between the stages of one step, and what a step reports.
#pragma once

#include <cstdint>
#include <vector>

#include "gotai/core/types.h"
#include "gotai/model/settings.h"

namespace gotai::model {

/// How an impulse method wants a step to be run. Made by ImpulseMethod::plan().
struct StepPlan {
  double dt = 0.0;              ///< the whole step [s]
  int substeps = 1;             ///< >= 1
  double contact_margin = 0.0;  ///< contacts are found up to this gap [m]; 0: only what touches
  /// Poses move with the old velocities before impulses act, and gravity comes last (literal 4.19).
  bool positions_first = false;
  bool relax = false;             ///< a second, unbiased solve after the poses have moved
  bool refresh_contacts = false;  ///< gaps are refreshed from anchors in every sub-step

  double substep_dt() const { return dt / substeps; }
};

/// Velocity changes that a solve asks for. Written by the impulse method, applied by dynamics.
struct Update {
  std::vector<Vec3> delta_v;  ///< [m/s] per body, W
  std::vector<Vec3> delta_L;  ///< angular impulse [N m s] per body, W
  /// Velocities that only correct positions and are forgotten afterwards. Empty when unused.
  std::vector<Vec3> push_v;  ///< [m/s] per body, W
  std::vector<Vec3> push_w;  ///< [rad/s] per body, W
  /// Impulse on body a per raw contact, summed over sub-steps [N s], W.
  std::vector<Vec3> contact_impulse;

  /// Zeroes everything for this many bodies and contacts; storage is kept.
  void reset(std::size_t bodies, std::size_t contacts);
  /// Zeroes the changes of the bodies, keeps the contact impulses (between sub-steps).
  void clear_changes();
};

/// What an impulse method did. Written by ImpulseMethod::report().
struct SolveReport {
  double residual = 0.0;         ///< largest natural-map residual of all islands, in velocity [m/s]
  std::uint32_t islands = 0;     ///< groups of bodies that touch
  std::uint32_t rows = 0;        ///< unknowns that were solved for (contacts, or apparent contacts)
  std::uint32_t iterations = 0;  ///< largest number of iterations of an island
  std::uint32_t substeps = 1;
  /// Islands solved without restitution, since with it and friction wedged bodies had no solution.
  std::uint32_t plastic_islands = 0;
};

/// Mechanical energy [J]. total = kinetic + potential + correction; see World::energy().
struct Energy {
  double kinetic = 0.0;
  double potential = 0.0;
  /// 1/2 dt sum m g.v: makes the total of a semi-implicit step exact in free flight
  /// (spec/experiments.md, "Energy").
  double correction = 0.0;
  double total() const { return kinetic + potential + correction; }
};

/// Measurements of one step.
struct StepReport {
  std::uint64_t step = 0;      ///< 1 for the first
  double time = 0.0;           ///< at the end of the step [s]
  double dt = 0.0;             ///< [s]
  std::uint32_t pairs = 0;     ///< touching pairs
  std::uint32_t contacts = 0;  ///< raw contacts
  std::uint64_t tests = 0;     ///< sphere-sphere and sphere-plane tests (or surface samples)
  double max_overlap = 0.0;    ///< the collision model's own overlap [m]
  double mean_overlap = 0.0;   ///< over contacts with overlap [m]
  Energy energy;
  SolveReport solve;
  /// Wall-clock time by phase [s].
  double collision_s = 0.0;
  double impulse_s = 0.0;
  double integration_s = 0.0;
  double other_s = 0.0;
  double total_s() const { return collision_s + impulse_s + integration_s + other_s; }
};

}  // namespace gotai::model
