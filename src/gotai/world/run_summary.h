/// @file
/// What a whole run did and what it could not hold: the totals behind `gotai run --json` and the
/// certificate in a recording.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "gotai/core/types.h"
#include "gotai/model/step.h"
#include "gotai/world/true_overlap.h"

namespace gotai {

class World;

/// Totals of a run. Times are wall-clock [ms] unless said otherwise.
struct RunSummary {
  std::uint64_t bodies =
      0;  ///< dynamic and kinematic ones and fixed shapes; planes, containers not
  std::uint64_t steps = 0;
  double simulated_s = 0.0;
  double wall_s = 0.0;  ///< from the start of the run to its end, everything included

  struct StepMilliseconds {
    double mean = 0.0;
    double p95 = 0.0;
    double max = 0.0;
    double last_second_mean = 0.0;  ///< over the steps of the last simulated second
  } step_ms;

  /// Mean per step.
  struct PhaseMilliseconds {
    double collision = 0.0;
    double impulse = 0.0;
    double integration = 0.0;
    double other = 0.0;
  } phase_ms;

  /// Per step.
  struct Contacts {
    double mean = 0.0;
    std::uint64_t max = 0;
  } contacts;

  /// The collision model's own, over the whole run.
  struct Overlap {
    double max = 0.0;   ///< [m]
    double mean = 0.0;  ///< [m] over all contacts of all steps
  } overlap;

  TrueOverlap true_overlap;  ///< of the meshes as given, in the final state

  /// Smallest ratio of the step in which no surface point moves farther than a voxel's radius
  /// [Makino 2007, eq. 4.29] to the step that was made; below 1 contacts had to be found ahead.
  double step_margin = std::numeric_limits<double>::infinity();

  /// As docs/notation.md defines it.
  struct EnergyTotals {
    double initial = 0.0;  ///< [J]
    double final = 0.0;    ///< [J]
    /// Largest rise above an earlier value [J], with the correction term of each step's own size.
    /// Kinematic bodies and applied forces do work, too.
    double max_gain = 0.0;
  } energy;

  /// Largest change of the dynamic bodies' momentum in a step that neither gravity nor the contacts
  /// with other bodies explain, as a fraction of the run's largest sum of m |v|.
  double momentum_error = 0.0;
  double residual_max = 0.0;          ///< largest residual of the impulse solver [m/s]
  std::uint64_t plastic_islands = 0;  ///< solved without restitution, summed over the steps
  std::uint64_t substeps_max = 1;     ///< of a step
  std::uint64_t escaped = 0;  ///< dynamic bodies whose centre of mass is inside a plane's or a
                              ///< container's solid at the end
  std::string state_hash;     ///< of the final state
};

/// Watches a world step by step and sums up. Attach on_step as an observer of the world.
class RunMonitor {
 public:
  /// Remembers where the run starts.
  explicit RunMonitor(const World& world);

  void on_step(const World& world, const model::StepReport& report);

  /// Totals up to now, and the overlap of the true meshes in the present state.
  /// @param wall_s  time that the run took [s]
  RunSummary summary(const World& world, double wall_s) const;

 private:
  RunSummary totals_;  // sums, to be divided by the number of steps
  double start_time_ = 0.0;
  model::Energy energy_;        // after the last step; its correction is per second of sub-step
  double energy_change_ = 0.0;  // since the start [J]
  double lowest_change_ = 0.0;
  double overlap_sum_ = 0.0;
  Vec3 momentum_ = Vec3::Zero();
  double largest_momentum_ = 0.0;
  double momentum_defect_ = 0.0;
  double next_safe_step_ = 0.0;       // from the present velocities [s]
  std::vector<double> step_times_;    // [s] simulated, at the end of each step
  std::vector<double> step_seconds_;  // [s] wall
};

}  // namespace gotai
