// The world as its users see it: building, changing, reading, state.
#include <gmock/gmock.h>

#include "gotai/core/error.h"
#include "gotai/core/parallel.h"
#include "gotai/geometry/generate.h"
#include "gotai/world/motion.h"
#include "gotai/world/world.h"

namespace gotai {
namespace {

using ::testing::HasSubstr;

std::shared_ptr<const voxel::Shape> shape_of(const char* name, int level) {
  geometry::GeneratorOptions options;
  options.shape = name;
  voxel::ShapeOptions how;
  how.prepared_level = level;
  how.surface_level = 0;
  return std::make_shared<const voxel::Shape>(
      voxel::make_shape(name, geometry::generate(options), how));
}

model::Settings settings_at(int level, double dt) {
  model::Settings settings;
  settings.gravity = Vec3(0, 0, -9.8);
  settings.collision.model = model::CollisionModel::spheres;
  settings.collision.level = level;
  settings.time.step = dt;
  return settings;
}

BodyDescription body_at(ShapeId shape, const Vec3& com) {
  BodyDescription body;
  body.shape = shape;
  body.com_position = com;
  body.mass = 1.0;
  return body;
}

/// A few hexapods that fall, touch and tumble.
World small_pile() {
  World world(settings_at(4, 0.01));
  world.add_plane({});
  const ShapeId shape = world.add_shape(shape_of("hexapod", 5));
  for (int k = 0; k < 4; ++k) {
    BodyDescription body = body_at(shape, Vec3(0.1 * k, -0.05 * k, 1.4 + 2.2 * k));
    body.X_WM.q = Quat(1.0, 0.3 * k, -0.2, 0.1 * k).normalized();
    world.add_body(body);
  }
  return world;
}

TEST(World, FreeFallIsTheExactSolutionOfTheScheme) {
  World world(settings_at(3, 0.01));
  const ShapeId shape = world.add_shape(shape_of("cube", 3));
  BodyDescription body = body_at(shape, Vec3(0, 0, 10));
  body.velocity = Vec3(1, 0, 2);
  const BodyId id = world.add_body(body);
  const double before = world.energy().total();
  const int n = 100;
  for (int k = 0; k < n; ++k) world.step();
  const Vec3 x = world.bodies().x_W[world.index(id)];
  EXPECT_NEAR(x.x(), 1.0, 1e-12);
  EXPECT_NEAR(x.z(), 10.0 + 2.0 - 9.8 * 1e-4 * n * (n + 1) / 2.0, 1e-11);
  // The first value has no step behind it; its correction starts with the first step.
  const double start = before + 0.5 * 0.01 * Vec3(0, 0, -9.8).dot(body.velocity);
  EXPECT_NEAR(world.energy().total(), start, 1e-10);
}

TEST(World, LoadsActForOneStepOnly) {
  model::Settings settings = settings_at(3, 0.1);
  settings.gravity.setZero();
  World world(settings);
  const BodyId id = world.add_body(body_at(world.add_shape(shape_of("cube", 3)), Vec3::Zero()));
  world.apply_force(id, Vec3(2, 0, 0), Vec3(0, 0.5, 0));
  world.apply_torque(id, Vec3(0, 0, 1.0));
  world.step();
  world.step();
  EXPECT_LT((world.bodies().v_W[0] - Vec3(0.2, 0, 0)).norm(), 1e-15);
  // The force at (0, 1/2, 0) turns by -1, the torque by +1: they cancel.
  EXPECT_LT(world.bodies().w_W[0].norm(), 1e-15);
  world.apply_impulse(id, Vec3(0, 0, 3), world.bodies().x_W[0]);
  EXPECT_NEAR(world.bodies().v_W[0].z(), 3.0, 1e-15);
}

TEST(World, BodiesComeAndGoBetweenSteps) {
  World world = small_pile();
  world.run_until(0.5);
  const BodyId gone = world.id(2);
  const BodyId kept = world.id(3);
  const Vec3 x = world.bodies().x_W[3];
  world.remove_body(gone);
  EXPECT_EQ(world.bodies().x_W[world.index(kept)], x);
  EXPECT_THROW(static_cast<void>(world.index(gone)), InvalidArgument);
  world.run_until(1.0);
  EXPECT_NE(world.id(static_cast<model::BodyIndex>(world.bodies().size() - 1)), gone);
}

TEST(World, SnapshotsResumeBitForBit) {
  World world = small_pile();
  world.run_until(0.8);
  const Snapshot middle = world.snapshot();
  const Hash128 hash_middle = world.state_hash();
  world.run_until(1.6);
  const Hash128 end = world.state_hash();
  World resumed = small_pile();
  resumed.restore(middle);
  EXPECT_EQ(resumed.state_hash(), hash_middle);
  resumed.run_until(1.6);
  EXPECT_EQ(resumed.state_hash(), end);
}

TEST(World, SameBitsForOneAndTwoThreads) {
  Hash128 hash[2];
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    World world = small_pile();
    world.run_until(1.5);
    hash[threads - 1] = world.state_hash();
  }
  EXPECT_EQ(hash[0], hash[1]);
}

TEST(World, ContactsOfABodyCarryItsWeight) {
  World world(settings_at(4, 0.01));
  world.add_plane({});
  const auto shape = shape_of("cube", 4);
  const double half =
      0.5 - 0.5 * shape->pyramid.grid.voxel_edge(4) + shape->pyramid.grid.voxel_radius(4);
  const BodyId id = world.add_body(body_at(world.add_shape(shape), Vec3(0, 0, half - 1e-6)));
  for (int k = 0; k < 10; ++k) world.step();
  Vec3 sum = Vec3::Zero();
  for (const BodyContact& contact : world.contacts_of(id)) {
    EXPECT_NEAR(contact.normal_W.z(), 1.0, 1e-12);
    sum += contact.impulse_W;
  }
  EXPECT_EQ(world.contacts_of(id).size(), 64U);
  EXPECT_LT((sum - Vec3(0, 0, 9.8 * 0.01)).norm(), 1e-9);
}

TEST(World, KinematicBodiesFollowTheirFrames) {
  World world(settings_at(3, 0.01));
  BodyDescription body;
  body.shape = world.add_shape(shape_of("cube", 3));
  body.kind = model::BodyKind::kinematic;
  body.motion = {{0.0, {Vec3::Zero(), Quat::Identity()}},
                 {1.0, {Vec3(1, 0, 0), Quat(Eigen::AngleAxisd(1.0, Vec3::UnitZ()))}}};
  const BodyId id = world.add_body(body);
  world.run_until(0.5);
  EXPECT_LT((world.mesh_pose(id).p - Vec3(0.5, 0, 0)).norm(), 1e-12);
  EXPECT_LT((world.bodies().w_W[0] - Vec3(0, 0, 1)).norm(), 1e-9);
  world.run_until(2.0);
  EXPECT_LT((world.mesh_pose(id).p - Vec3(1, 0, 0)).norm(), 1e-12);
  EXPECT_EQ(world.bodies().v_W[0], Vec3(Vec3::Zero()));
}

TEST(World, SaysWhatIsWrong) {
  World world(settings_at(4, 0.01));
  const auto message = [](const auto& f) -> std::string {
    try {
      f();
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_THAT(message([&] { world.add_shape(shape_of("cube", 3)); }),
              HasSubstr("prepared only to level 3"));
  const ShapeId shape = world.add_shape(shape_of("cube", 4));
  BodyDescription body = body_at(shape, Vec3::Zero());
  body.mass = -1.0;
  EXPECT_THAT(message([&] { world.add_body(body); }), HasSubstr("body.mass = -1"));
  body.mass = 1.0;
  body.motion = {{0.0, {}}};
  EXPECT_THAT(message([&] { world.add_body(body); }), HasSubstr("only kinematic"));
  EXPECT_THAT(message([&] {
                world.add_plane({"", Vec3::Zero(), Vec3::Zero(), 0});
              }),
              HasSubstr("direction"));
  const BodyId id = world.add_body(body_at(shape, Vec3(0, 0, 5)));
  world.apply_force(id, Vec3(1e300, 0, 0), Vec3(0, 1e10, 0));
  EXPECT_THAT(message([&] { world.step(); }), HasSubstr("body 0"));
}

}  // namespace
}  // namespace gotai
