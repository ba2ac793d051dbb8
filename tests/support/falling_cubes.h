// A small world for tests of recordings: cubes over a plane and a container.
#pragma once

#include <fmt/format.h>

#include <memory>
#include <utility>

#include "gotai/geometry/generate.h"
#include "gotai/voxel/shape.h"
#include "gotai/world/world.h"

namespace gotai::test {

/// n cubes of edge 1 above each other, turned and spinning, fixed step of 1/100 s.
inline World falling_cubes(int n) {
  model::Settings settings;
  settings.collision.model = model::CollisionModel::spheres;
  settings.collision.level = 3;
  settings.time.step = 0.01;
  World world(settings);
  const auto shape = std::make_shared<const voxel::Shape>(voxel::make_shape(
      "cube", geometry::generate({.shape = "cube"}), {.prepared_level = 3, .surface_level = 0}));
  world.add_shape(shape);
  world.add_plane({.name = "floor"});
  world.add_container({.name = "tray", .floor_center = {5, 0, 0}, .inner = {2, 2, 1}});
  for (int i = 0; i < n; ++i) {
    BodyDescription body;
    body.name = fmt::format("cube {}", i + 1);
    body.X_WM.p = Vec3(0.1 * i, 0.0, 1.2 + 2.0 * i);
    body.X_WM.q = Quat(Eigen::AngleAxisd(0.3 + 0.2 * i, Vec3(1, 2, 3).normalized()));
    body.angular_velocity = Vec3(0.5, 0.0, 1.0);
    world.add_body(body);
  }
  return world;
}

}  // namespace gotai::test
