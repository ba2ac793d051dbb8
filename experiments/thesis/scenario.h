/// @file
/// What the thesis's experiments have in common: SI units, g = 9.8 m/s^2, floor z = 0, mass 1 kg.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "experiment.h"
#include "gotai/geometry/generate.h"
#include "gotai/voxel/shape.h"
#include "gotai/world/world.h"

namespace gotai::experiments {

inline constexpr double kGravity = 9.8;  ///< [m/s^2]
/// Finest level of the pyramid where an experiment does not prepare each level directly.
inline constexpr int kFinestPrepared = 7;
/// Coarsest level of the surface model.
inline constexpr int kCoarsestSurface = voxel::kMinSurfaceLevel;

/// What a point of most sweeps says: method, collision model, level, step. Keys of the same names.
struct Setup {
  std::string method = "C";       ///< C constraint, A apparent, I averaged, S superposed impulses
  std::string model = "spheres";  ///< or "surface"
  int level = 5;
  double dt = 0.01;  ///< [s]
  double restitution = 0.5;
  double friction = 0.0;
  bool explicit_euler = false;
  /// C with the surface model keeps few contacts per patch, as scenes of many bodies are run.
  bool reduced = false;
  /// .. and solves them in sub-steps; else C and A solve to round-off.
  bool substepped = false;
};

/// Fills a setup from the keys of a point that are there (method, model, level, dt, integrator).
Setup setup_of(const Json& point, Setup defaults);

/// Settings of a world for a setup.
model::Settings settings_of(const Setup& setup);

/// A world with one default material and a floor.
World world_with_floor(const Setup& setup);

/// A generated shape, prepared for the collision model of a setup: the pyramid down to level
/// `finest`, the surface model at the setup's own level. Prepared once per program.
std::shared_ptr<const voxel::Shape> prepare(const geometry::GeneratorOptions& options, int finest,
                                            const Setup& setup);

/// The same of any mesh.
std::shared_ptr<const voxel::Shape> prepare(const std::string& name, geometry::Mesh mesh,
                                            int finest, const Setup& setup);

/// Processor time of the calling thread [s]: what a busy machine does to others is not in it.
double thread_seconds();

/// Adds a 1 kg body by the position of its centre of mass.
BodyId add_unit_body(World& world, ShapeId shape, const Vec3& x_W,
                     const Quat& q_WB = Quat::Identity(), const Vec3& v_W = Vec3::Zero(),
                     const Vec3& w_W = Vec3::Zero());

/// Heights after each step of what the scheme itself makes of the fall of a point that bounces
/// with e: no shape, no level, no solver. The step in which the floor would be passed turns the
/// speed before the step (spec: row target). An error beside it is the collision model's alone.
/// @param v0  upward velocity at the start [m/s]
std::vector<double> scheme_heights(double z0, double z_touch, double v0, double e, double dt,
                                   double duration);

/// Height of a ball that is dropped from z0 on a floor where it touches at z_touch, bouncing with
/// e, at time t: the analytic solution of the free-fall experiments [m].
double bouncing_height(double z0, double z_touch, double e, double t);

/// Height of the centre of mass at which a turned shape touches the floor z = 0 in the setup's
/// collision model [m].
double touching_height(const voxel::Shape& shape, const Quat& q_WB, const Setup& setup);

/// The middle value; the mean of the two middle ones of an even number.
double median(std::vector<double> values);

/// A metric by level, one line per method and model.
Plot by_level(const std::vector<Record>& records, const std::string& metric, std::string figure,
              std::string title, std::string y_label, bool log_y);

/// A metric as a table: one row per method and model, one column per level.
Table level_table(const std::vector<Record>& records, const std::string& metric, std::string number,
                  std::string title);

/// Adds a plot and a table of "total_ms" and of "impulse_ms" by level, which time_runs writes.
/// @param what  runs, and for how long: "Falling sphere", 3 [s]
void show_times(Outcome& outcome, const std::vector<Record>& records, const std::string& what,
                double duration, const std::string& total_table, const std::string& impulse_table);

/// Root mean square of the differences.
double rms(const std::vector<double>& a, const std::vector<double>& b);

/// Totals that every record reports: energy, overlap, contacts, steps (spec: "Common").
struct Totals {
  explicit Totals(World& world);  ///< watches the world from now on; must not outlive it
  /// Writes steps, contacts_mean, contacts_max, overlap_max, energy_gain into a record.
  void write(Json& record) const;

  double collision_s = 0.0;  ///< summed wall-clock time by phase [s]
  double impulse_s = 0.0;
  double integration_s = 0.0;
  double total_s = 0.0;
  std::uint64_t tests = 0;

 private:
  std::uint64_t steps_ = 0;
  std::uint64_t contacts_ = 0;
  std::uint64_t contacts_max_ = 0;
  double overlap_max_ = 0.0;
  double lowest_energy_;
  double energy_gain_ = 0.0;
};

/// Runs a scene several times on one thread and writes the median times of a run (total_ms,
/// detection_ms, impulse_ms, integration_ms), the least impulse time (impulse_least_ms) and the
/// totals of the last.
/// @param duration  of a run [s]
void time_runs(const std::function<World()>& make_world, double duration, int repeats,
               Json& record);

/// Errors by ascending level fall from each level to the next, or are below `floor`: what is left
/// there is not the level's (round-off, the step's own error).
/// @param noise  errors that differ by less are the same; the last must be below the first
Verdict falls_with_level(std::string what, const std::vector<double>& errors, double floor,
                         double noise = 0.0);

/// "C", "surface" -> "C, surface": label of a line in plots.
std::string label_of(const Json& record);

}  // namespace gotai::experiments
