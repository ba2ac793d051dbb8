// Drops one block on a floor: the ten lines of the README.
#include <gotai/geometry/generate.h>
#include <gotai/voxel/shape.h>
#include <gotai/world/world.h>
#include <cstdio>

int main() {
  const auto mesh = gotai::geometry::generate({.shape = "hexapod", .size = 1.0});
  const auto shape = gotai::voxel::make_shape("block", mesh, {.prepared_level = 6});
  gotai::World world;
  world.add_plane({.name = "floor"});
  const auto block =
      world.add_body({.name = "block",
                      .shape = world.add_shape(std::make_shared<gotai::voxel::Shape>(shape)),
                      .X_WM = {.p = {0.0, 0.0, 2.0}}});
  world.run_until(2.0);
  std::printf("t = %.2f s: the block is at z = %.3f m\n", world.time(),
              world.mesh_pose(block).p.z());
}
