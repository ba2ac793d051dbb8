/// @file
/// Seeded drops of several bodies on the floor: the scenes of the pile and rock experiments.
#pragma once

#include <vector>

#include "thesis/scenario.h"

namespace gotai::experiments {

/// Several equal bodies above each other, shifted and turned by a seed.
struct Drop {
  std::shared_ptr<const voxel::Shape> shape;
  double extent = 1.0;  ///< L, the largest extent [m]
  int count = 4;
  std::uint64_t seed = 1;
  double perturbation = 0.0;  ///< added to every start position, for the noise floor [m]
};

/// Adds the bodies: the i-th at z = (0.7 + 1.05 i) L, shifted sideways by up to 0.15 L, with a
/// seeded rotation.
void add_drop(World& world, const Drop& drop);

/// Centres of mass of all dynamic bodies, sampled every 1/50 s: one row per sample.
using Trajectory = std::vector<std::vector<Vec3>>;

/// Runs a world and samples it. @param duration  [s]
Trajectory sample(World& world, double duration);

/// Runs on one thread and samples. @param duration  [s]
Trajectory run_drop(const Setup& setup, const Drop& drop, double duration);
/// The same, and writes the totals of the run into a record.
Trajectory run_drop(const Setup& setup, const Drop& drop, double duration, Json& record);

/// Mean over bodies and samples of the distance between two trajectories, as a fraction of the
/// extent.
double mean_error(const Trajectory& a, const Trajectory& b, double extent);

/// The scenes of Figs. 6-28 and 6-29: "blocks", 27 boxes and 8 hexapods, or "rocks", 64 of them.
void add_crowd(World& world, const std::string& scene, const Setup& setup, std::uint64_t seed = 7);

/// Step for a level: 1/50, 1/100, 1/200, 1/400 s for levels 3, 4, 5, 6.
double step_of_level(int level);

}  // namespace gotai::experiments
