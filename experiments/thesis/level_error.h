/// @file
/// The error of the surface model by level against a reference that knows no level, for the scenes
/// whose own records are times and counts.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "thesis/scenario.h"

namespace gotai::experiments {

/// A scene by seed. Levels 3 to 5 run with the reference's step and are solved to round-off, so
/// that what is left is the level's own; the reference is level 6. The window ends before
/// trajectories that differ by 1e-6 m at the start have drifted apart (erratum 47).
struct LevelErrorScene {
  std::string id;  ///< of the experiment and scene: references are kept by it
  /// A world of the scene, in the setup's model, at its level and step.
  std::function<World(const Setup&, std::uint64_t seed)> make;
  Setup setup;          ///< restitution, friction; the rest is filled in
  double extent = 1.0;  ///< L, the unit of the error [m]
  double window = 1.0;  ///< [s]
};

/// Points {"method", "model", "level", "seed", "measure": "error"}: levels 3 to 5, and the noise
/// floor: the reference against itself, every body started 1e-6 m aside.
/// @param more  keys that every point gets ({"scene": "rocks"})
void add_level_error_points(std::vector<Json>& points, int seeds,
                            const Json& more = Json::object());

/// Runs such a point: "error" [L], the mean over bodies and samples of the distance of the centres
/// of mass, beside the totals of the run.
Json run_level_error(const Json& point, const LevelErrorScene& scene);

/// Judges that the medians over the seeds fall with the level, and shows them as a plot.
/// @param records  those of one scene with "measure": "error"
void judge_level_error(Outcome& outcome, const std::vector<Record>& records,
                       const std::string& what);

}  // namespace gotai::experiments
