// Rolling resistance of the sub-stepped solver: a torque of at most arm times load.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/worlds.h"

namespace gotai {
namespace {

constexpr double kFall = 9.8;
constexpr double kBallRadius = 0.5;
constexpr double kResistance = 0.05;  // above what bodies at rest have anyway
constexpr double kFrame = 1.0 / 60.0;

struct BallRun {
  World world;
  BodyId ball;

  Vec3 v() const { return world.bodies().v_W[world.index(ball)]; }
  Vec3 w() const { return world.bodies().w_W[world.index(ball)]; }
};

// A ball on a plane that is tilted about y, no restitution, mu = 0.5.
BallRun start_ball(double resistance, double tilt, const Vec3& v, const Vec3& w) {
  static const auto shape = test::surface_shape(
      {.shape = "rock", .size = 2 * kBallRadius, .subdivisions = 5, .roughness = 0.0}, 6);
  model::Settings settings;
  settings.gravity = Vec3(0, 0, -kFall);
  settings.time.step = kFrame;
  settings.impulse.rolling_resistance = resistance;
  World world(settings);
  world.set_default_material(test::surface_material(0.0, 0.5));
  const Quat q(Eigen::AngleAxisd(tilt, Vec3::UnitY()));
  PlaneDescription plane;
  plane.normal = q * Vec3::UnitZ();
  world.add_plane(plane);
  BodyDescription body;
  body.shape = world.add_shape(shape);
  body.com_position = q * Vec3(0, 0, kBallRadius);
  body.velocity = v;
  body.angular_velocity = w;
  const BodyId ball = world.add_body(body);
  return {std::move(world), ball};
}

// The torque c m g R turns against the rolling, friction keeps the contact from slipping:
// m dv/dt = -f and 2/5 m R^2 dw/dt = f R - c m g R with v = w R give dv/dt = -5/7 c g.
TEST(RollingResistance, ABallSlowsDownByFiveSeventhsOfItAndStops) {
  BallRun r = start_ball(kResistance, 0.0, Vec3(1, 0, 0), Vec3(0, 1 / kBallRadius, 0));
  const double slowing = 5.0 / 7.0 * kResistance * kFall;
  r.world.run_until(1.0);
  EXPECT_NEAR(1.0 - r.v().x(), slowing * r.world.time(), 0.01 * slowing);
  r.world.run_until(2.0);
  EXPECT_NEAR(1.0 - r.v().x(), slowing * r.world.time(), 0.02 * slowing);
  r.world.run_until(1.0 / slowing + 0.2);
  EXPECT_LT(r.v().norm(), 1e-5);
  EXPECT_LT(r.w().norm(), 1e-5);
}

// The same torque about the normal: 2/5 m R^2 dw/dt = -c m g R.
TEST(RollingResistance, ASpinningBallStops) {
  BallRun r = start_ball(kResistance, 0.0, Vec3::Zero(), Vec3(0, 0, 10));
  const double slowing = 2.5 * kResistance * kFall / kBallRadius;
  double energy = r.world.energy().total();
  while (!r.world.has_reached(2.0)) {
    const double now = r.world.step().energy.total();
    EXPECT_LE(now, energy + 1e-6);  // [J] of 1,000 and more
    energy = now;
  }
  EXPECT_NEAR(10.0 - r.w().z(), slowing * r.world.time(), 0.02 * slowing);
  r.world.run_until(10.0 / slowing + 0.2);
  EXPECT_LT(r.w().norm(), 1e-5);
}

// On a slope, the torque of the weight about the contact is m g R sin, that of the resistance at
// most c m g R cos.
TEST(RollingResistance, ABallStaysOnSlopesThatAreLessAndRollsDownOthers) {
  BallRun stays = start_ball(kResistance, std::atan(0.9 * kResistance), Vec3::Zero(), Vec3::Zero());
  const Vec3 start = stays.world.bodies().x_W[stays.world.index(stays.ball)];
  stays.world.run_until(5.0);
  EXPECT_LT((stays.world.bodies().x_W[stays.world.index(stays.ball)] - start).norm(), 1e-3);
  EXPECT_LT(stays.v().norm(), 1e-5);

  const double tilt = std::atan(2.0 * kResistance);
  BallRun rolls = start_ball(kResistance, tilt, Vec3::Zero(), Vec3::Zero());
  rolls.world.run_until(1.0);
  const double exact = 5.0 / 7.0 * kFall * (std::sin(tilt) - kResistance * std::cos(tilt));
  EXPECT_NEAR(rolls.v().norm(), exact * rolls.world.time(), 0.02 * exact);
}

// Bodies that hardly turn resist more, so that piles rest; what rolls in earnest hardly notices.
TEST(RollingResistance, ByDefaultBallsRollOnAndStopWhenTheyAreSlow) {
  const double usual = model::ImpulseSettings().rolling_resistance;
  BallRun fast = start_ball(usual, 0.0, Vec3(1, 0, 0), Vec3(0, 1 / kBallRadius, 0));
  fast.world.run_until(5.0);
  EXPECT_GE(fast.v().x(), 0.99);
  const double v = 0.08;
  BallRun slow = start_ball(usual, 0.0, Vec3(v, 0, 0), Vec3(0, v / kBallRadius, 0));
  slow.world.run_until(0.3);
  const double slowing = 5.0 / 7.0 * model::kRestingResistance * kFall;
  EXPECT_NEAR(v - slow.v().x(), slowing * slow.world.time(), 0.02 * slowing);
  slow.world.run_until(1.0);
  EXPECT_LT(slow.v().norm(), 1e-5);
  const double tilt = 10.0 * M_PI / 180.0;
  BallRun down = start_ball(usual, tilt, Vec3::Zero(), Vec3::Zero());
  down.world.run_until(1.0);
  const double exact = 5.0 / 7.0 * kFall * std::sin(tilt) * down.world.time();
  EXPECT_NEAR(down.v().norm(), exact, 0.03 * exact);
}

TEST(RollingResistance, OfNoneABallRollsOnForever) {
  BallRun r = start_ball(0.0, 0.0, Vec3(0.1, 0, 0), Vec3(0, 0.1 / kBallRadius, 0));
  r.world.run_until(5.0);
  EXPECT_GE(r.v().x(), 0.099);
}

}  // namespace
}  // namespace gotai
