// The pile workload: copies of a mesh fall into an open-top container and come to rest.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "gotai/core/types.h"
#include "gotai/geometry/mesh.h"
#include "gotai/model/settings.h"
#include "gotai/world/true_overlap.h"
#include "gotai/world/world.h"

namespace gotai::pile {

struct Options {
  std::string folder, mesh;
  int bodies = 0;
  double seconds = 5.0;
  int repeat = 1;  // runs of the same; what counts is the least time of each step
  int level = 6;
  int threads = 1;
  int copies_x = 1, copies_y = 1;  // of the pile, side by side in one container
  double shift = 0.0;              // of all bodies along x [m]
  double rolling_resistance = model::ImpulseSettings().rolling_resistance;
  std::vector<std::string> compare;  // other engines
  bool verbose = false;
  bool memory = false;
  bool judged = true;
  model::ContactTreatment contacts = model::ContactTreatment::reduced;
};

constexpr double kStep = 1.0 / 60.0;
constexpr double kDensity = 1000.0;
constexpr double kFriction = 0.5;
constexpr double kRestitution = 0.2;

// What falls, and where.
struct Pile {
  geometry::Mesh mesh;
  Vec3 inner = Vec3::Zero();  // of the container: two edges and the height [m]
  std::vector<Pose> poses;    // of the mesh frame
};

/// @throws FileError naming the file that is missing or not a pile
Pile read_pile(const Options& options);

// Processor time, which means something on a busy machine; of all threads.
double cpu_seconds();

// How one engine did.
struct Result {
  std::string engine;
  double ms_per_step = 0.0, ms_last_second = 0.0, ms_worst = 0.0;  // processor time
  double contacts = 0.0;                                           // mean per step
  double us_per_contact = 0.0, us_per_contact_last_second = 0.0;   // processor time
  double rms_speed = 0.0;                                          // at the end [m/s]
  double energy_gain = 0.0;  // highest above the initial energy, as a fraction of it
  std::vector<Pose> poses;   // at the end, of the mesh frame
  // Judged from the poses:
  TrueOverlap overlap;
  int linked = 0;   // pairs of rings that are linked though they started apart
  int escaped = 0;  // centres of mass outside the container's walls or floor
};

Result run_gotai(const Options& options, const Pile& pile);

// Other engines by name; see rivals().
Result run_rival(const std::string& name, const Options& options, const Pile& pile);
const std::vector<std::string>& rivals();
/// @throws InvalidArgument for a name that is unknown or not in this build
void require_rival(const std::string& name);

Result run_ode(const Options& options, const Pile& pile);
bool has_ode();
Result run_bullet(const Options& options, const Pile& pile);
bool has_bullet();

// Bytes on the heap; contacts: of the most that there were at a time.
struct Memory {
  double surface_model = 0.0;  // of the shape: what collisions need
  double shape = 0.0;          // all of it: with the mesh and the voxels
  double prepared = 0.0;       // what a world prepares of the shape besides
  double per_body = 0.0;       // that touches nothing
  double per_contact = 0.0;    // in the pile
};
// @throws Error where the heap cannot be asked
Memory measure_memory(const Options& options, const Pile& pile);

using ShapePointer = std::shared_ptr<const voxel::Shape>;
ShapePointer make_pile_shape(const Options& options, const Pile& pile);
// The pile's bodies, of that shape, in its container.
World make_world(const Options& options, const Pile& pile, const ShapePointer& shape);

// Fills what follows from the final poses.
void judge(const Pile& pile, Result& result);

}  // namespace gotai::pile
