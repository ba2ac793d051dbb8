/// @file
/// Small worlds for tests, of one material: the thesis's (spheres, g = 9.8) and those with contacts
/// from the surfaces as users run them.
#pragma once

#include <cmath>
#include <string>

#include "gotai/geometry/generate.h"
#include "gotai/voxel/shape.h"
#include "gotai/world/world.h"

namespace gotai::test {

using ShapePointer = std::shared_ptr<const voxel::Shape>;

/// A generated shape with voxel spheres alone.
inline ShapePointer make_generated(const std::string& name, int level) {
  return std::make_shared<voxel::Shape>(voxel::make_shape(
      name, geometry::generate({.shape = name}), {.prepared_level = level, .surface_level = 0}));
}

/// A generated shape with its surface.
inline ShapePointer surface_shape(const geometry::GeneratorOptions& options, int level) {
  return std::make_shared<voxel::Shape>(
      voxel::make_shape(options.shape, geometry::generate(options),
                        {.prepared_level = level, .surface_level = level}));
}

/// Settings of the thesis's collision model at a level.
inline model::Settings thesis_settings(int level, double dt) {
  model::Settings settings;
  settings.gravity = Vec3(0.0, 0.0, -9.8);
  settings.collision.model = model::CollisionModel::spheres;
  settings.collision.level = level;
  settings.impulse.solver = model::SolverName::exact;
  settings.time.step = dt;
  return settings;
}

inline model::Material surface_material(double restitution, double friction) {
  model::Material material;
  material.restitution = restitution;
  material.friction = friction;
  return material;
}

/// An empty world with contacts from the surfaces.
/// @param dt  step [s]
inline World surface_world(int level, const model::Material& material, double dt = 1.0 / 60.0,
                           const Vec3& gravity = Vec3(0.0, 0.0, -9.81)) {
  model::Settings settings;
  settings.gravity = gravity;
  settings.collision.level = level;
  settings.time.step = dt;
  World world(settings);
  world.set_default_material(material);
  return world;
}

/// A cube of edge 1 and 1 kg over the floor z = 0.
struct CubeWorld {
  World world;
  BodyId cube;

  /// @param gap  between the cube's lowest voxel spheres and the floor [m]
  CubeWorld(const model::Settings& settings, double restitution, double friction, double gap,
            const Vec3& v = Vec3::Zero(), const Vec3& w = Vec3::Zero(),
            const Quat& tilt = Quat::Identity())
      : world(settings) {
    world.set_default_material(surface_material(restitution, friction));
    BodyDescription body;
    body.shape = world.add_shape(make_generated("cube", settings.collision.level));
    body.mass = 1.0;
    body.com_position = tilt * Vec3(0, 0, 0.5 + sphere_offset(settings.collision.level) + gap);
    body.X_WM.q = tilt;
    body.velocity = tilt * v;
    body.angular_velocity = tilt * w;
    cube = world.add_body(body);
    PlaneDescription plane;
    plane.normal = tilt * Vec3::UnitZ();
    world.add_plane(plane);
  }
  Vec3 position() const { return world.bodies().x_W[world.index(cube)]; }
  Vec3 velocity() const { return world.bodies().v_W[world.index(cube)]; }
  Vec3 spin() const { return world.bodies().w_W[world.index(cube)]; }

  /// How far the lowest voxel spheres reach below the faces of a cube of edge 1: 0.366 s.
  static double sphere_offset(int level) {
    const double edge = std::ldexp(1.0, 1 - level);
    return 0.5 * (std::sqrt(3.0) - 1.0) * edge;
  }
};

}  // namespace gotai::test
