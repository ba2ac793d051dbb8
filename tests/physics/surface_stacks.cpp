// Stacks on contacts from the surfaces, reduced, stand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "gotai/core/random.h"
#include "support/worlds.h"

namespace gotai {
namespace {

constexpr int kStackLevel = 6;
constexpr int kCubes = 10;

struct Stand {
  double drift = 0.0;      // farthest that a cube is from where it was put [edges]
  double rms_speed = 0.0;  // over the last second [m/s]
  double gain = 0.0;       // highest energy above the first, as a fraction of it
};

// Ten cubes of edge 1 m, each put down aside and turned at random by at most this.
Stand stack_for_ten_seconds(double aside, double turned, unsigned seed) {
  World world = test::surface_world(kStackLevel, test::surface_material(0.2, 0.5));
  world.add_plane({});
  static const auto cube = test::surface_shape({.shape = "cube"}, kStackLevel);
  const ShapeId shape = world.add_shape(cube);
  Random random(seed);
  for (int k = 0; k < kCubes; ++k) {
    BodyDescription body;
    body.shape = shape;
    body.density = 1000.0;
    body.com_position = Vec3(aside * random.uniform(-1, 1), aside * random.uniform(-1, 1), k + 0.5);
    body.X_WM.q = Quat(Eigen::AngleAxisd(turned * random.uniform(-1, 1), Vec3::UnitZ()));
    world.add_body(body);
  }
  const std::vector<Vec3> start = world.bodies().x_W;
  const double initial = world.energy().total();
  Stand stand;
  double sum = 0.0;
  int count = 0;
  while (!world.has_reached(10.0)) {
    stand.gain = std::max(stand.gain, world.step().energy.total() / initial - 1.0);
    if (world.time() < 9.0) continue;
    for (const Vec3& v : world.bodies().v_W) sum += v.squaredNorm();
    count += kCubes;
  }
  for (std::size_t i = 1; i < start.size(); ++i)
    stand.drift = std::max(stand.drift, (world.bodies().x_W[i] - start[i]).norm());
  stand.rms_speed = std::sqrt(sum / count);
  std::printf("ten cubes, %.2f m aside, %.1f rad: drift %.1e, %.1e m/s, energy gain %.1e\n", aside,
              turned, stand.drift, stand.rms_speed, stand.gain);
  return stand;
}

TEST(SurfaceStacks, TenCubesStand) {
  for (const double aside : {0.01, 0.02, 0.03}) {
    const Stand stand = stack_for_ten_seconds(aside, 10.0 * aside, 5);
    EXPECT_LT(stand.drift, 1e-3);
    EXPECT_LT(stand.rms_speed, 1e-4);
    EXPECT_LT(stand.gain, 1e-6);
  }
}

// Edge on edge, where samples have many normals and the field has no slope to choose among them.
TEST(SurfaceStacks, TenCubesExactlyOnEachOtherStand) {
  const Stand stand = stack_for_ten_seconds(0.0, 0.0, 5);
  EXPECT_LT(stand.drift, 1e-3);
  EXPECT_LT(stand.rms_speed, 1e-4);
  EXPECT_LT(stand.gain, 1e-6);
}

}  // namespace
}  // namespace gotai
