// How bodies slide, spin and roll on contacts from the true surface.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "gotai/geometry/generate.h"
#include "gotai/world/world.h"

namespace gotai {
namespace {

using model::ContactTreatment;
using model::SolverName;

std::shared_ptr<const voxel::Shape> surface_shape(const geometry::GeneratorOptions& options,
                                                  int level) {
  voxel::ShapeOptions how;
  how.prepared_level = 3;
  how.surface_level = level;
  return std::make_shared<const voxel::Shape>(
      voxel::make_shape(options.shape, geometry::generate(options), how));
}

std::shared_ptr<const voxel::Shape> surface_cube(int level) {
  geometry::GeneratorOptions options;
  options.shape = "cube";
  return surface_shape(options, level);
}

World surface_world(double friction, double dt, SolverName solver, ContactTreatment contacts) {
  model::Settings settings;
  settings.gravity = Vec3(0, 0, -9.8);
  settings.collision.model = model::CollisionModel::surface;
  settings.collision.level = 3;
  settings.impulse.solver = solver;
  settings.impulse.contacts = contacts;
  settings.time.step = dt;
  World world(settings);
  model::Material material;
  material.restitution = 0.0;
  material.friction = friction;
  world.set_default_material(material);
  return world;
}

// Time until a cube of edge 1 that spins at 10 rad/s on the floor stands still.
double spin_down(int level, SolverName solver, ContactTreatment contacts, double dt) {
  World world = surface_world(0.3, dt, solver, contacts);
  BodyDescription body;
  body.shape = world.add_shape(surface_cube(level));
  body.mass = 1.0;
  body.com_position = Vec3(0, 0, 0.5);
  body.angular_velocity = Vec3(0, 0, 10);
  const BodyId cube = world.add_body(body);
  world.add_plane({});
  const auto spin = [&] { return world.bodies().w_W[world.index(cube)].z(); };
  while (spin() > 1e-3 && world.time() < 2.0) world.step();
  EXPECT_LE(world.bodies().x_W[world.index(cube)].head<2>().norm(), 0.05);
  return world.time();
}

// Uniform pressure over the whole face; 12 sum of lever arms / edge: errata 23.
constexpr double kUniformPressureStop = 1.4817;

TEST(SurfaceSpin, UniformPressureStopsACubeHoweverItsFaceIsSampled) {
  for (const int level : {4, 5}) {
    const double stop = spin_down(level, SolverName::exact, ContactTreatment::all, 5e-3);
    std::printf("level %d, all contacts, exact solver: stops after %.4f s\n", level, stop);
    EXPECT_NEAR(stop, kUniformPressureStop, 0.02 * kUniformPressureStop) << level;
  }
}

TEST(SurfaceSpin, ReducedContactsStopACubeAsAllDo) {
  for (const int level : {4, 5, 6}) {
    for (const SolverName solver : {SolverName::exact, SolverName::substepped}) {
      const double stop = spin_down(level, solver, ContactTreatment::reduced, 5e-3);
      std::printf("level %d, reduced, %s: stops after %.4f s\n", level, to_string(solver).data(),
                  stop);
      EXPECT_NEAR(stop, kUniformPressureStop, 0.02 * kUniformPressureStop)
          << level << " " << to_string(solver);
    }
  }
}

}  // namespace
}  // namespace gotai
