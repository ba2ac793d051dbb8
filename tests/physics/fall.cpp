// `fall` and `superpose` (Makino 2007, Figs. 4-4..4-7): a flat cube falls on the floor, by level
// and method, against the analytic solution.
#include <gtest/gtest.h>

#include "support/worlds.h"

namespace gotai {
namespace {

using model::ImpulseMethodName;

// Height of a cube that falls flat from z = 2 and bounces with e.
double analytic_height(double t, double e) {
  const double g = 9.8;
  double start = 0.0;
  double speed = 0.0;
  double height = 2.0;
  for (int bounce = 0; bounce < 200; ++bounce) {
    const double drop = height - 0.5;
    const double land = (speed + std::sqrt(speed * speed + 2 * g * drop)) / g;
    if (t <= start + land) break;
    start += land;
    speed = e * (g * land - speed);
    height = 0.5;
    if (speed < 1e-9) return 0.5;
  }
  const double s = t - start;
  return height + speed * s - 0.5 * g * s * s;
}

double fall_rms(int level, ImpulseMethodName method, model::Integrator integrator) {
  model::Settings settings = test::thesis_settings(level, 1e-3);
  settings.impulse.method = method;
  settings.time.integrator = integrator;
  test::CubeWorld scene(settings, 0.5, 0.0, 1.5 - test::CubeWorld::sphere_offset(level));
  double sum = 0.0;
  const int steps = 2000;
  for (int n = 1; n <= steps; ++n) {
    scene.world.step();
    const double error = scene.position().z() - analytic_height(n * 1e-3, 0.5);
    sum += error * error;
  }
  return std::sqrt(sum / steps);
}

struct FallCase {
  ImpulseMethodName method;
  model::Integrator integrator;
  std::vector<double> rms;  // levels 1..5
  double tolerance;
};

class Fall : public testing::TestWithParam<FallCase> {};

INSTANTIATE_TEST_SUITE_P(Methods, Fall,
                         testing::Values(FallCase{ImpulseMethodName::constraint,
                                                  model::Integrator::semi_implicit,
                                                  {0.2905, 0.1464, 0.0730, 0.0359, 0.0177},
                                                  0.03},
                                         FallCase{ImpulseMethodName::constraint,
                                                  model::Integrator::explicit_euler,
                                                  {0.287, 0.143, 0.070, 0.033, 0.0145},
                                                  0.05},
                                         FallCase{ImpulseMethodName::impulse,
                                                  model::Integrator::semi_implicit,
                                                  {0.291, 5.3, 44.0, 197.0, 812.0},
                                                  0.05},
                                         FallCase{ImpulseMethodName::impulse_averaged,
                                                  model::Integrator::semi_implicit,
                                                  {0.291, 0.127, 0.114, 0.127, 0.137},
                                                  0.05}));

TEST_P(Fall, RmsByLevel) {
  for (int level = 1; level <= 5; ++level) {
    const double expected = GetParam().rms[static_cast<std::size_t>(level - 1)];
    const double rms = fall_rms(level, GetParam().method, GetParam().integrator);
    RecordProperty("rms_level_" + std::to_string(level), std::to_string(rms));
    EXPECT_NEAR(rms, expected, GetParam().tolerance * expected) << "level " << level;
  }
}

TEST(Superpose, VelocityAfterOneImpactByLevel) {
  const std::vector<std::pair<ImpulseMethodName, std::vector<double>>> expected = {
      {ImpulseMethodName::impulse, {0.5, 2.43, 12.48, 52.4, 212.0}},
      {ImpulseMethodName::impulse_averaged, {0.5, -0.143, -0.158, -0.166, -0.168}},
      {ImpulseMethodName::constraint, {0.5, 0.5, 0.5, 0.5, 0.5}}};
  for (const auto& [method, velocities] : expected) {
    for (int level = 1; level <= 5; ++level) {
      model::Settings settings = test::thesis_settings(level, 1e-3);
      settings.gravity.setZero();
      settings.impulse.method = method;
      test::CubeWorld scene(settings, 0.5, 0.0, -1e-9, -Vec3::UnitZ());
      scene.world.step();
      const double v = velocities[static_cast<std::size_t>(level - 1)];
      EXPECT_NEAR(scene.velocity().z(), v, 0.05 * std::abs(v))
          << to_string(method) << " level " << level;
    }
  }
}

TEST(Sem, SticksWhereItLands) {
  // Fig. 4-4: the same as e = 0.
  for (int level = 2; level <= 4; ++level) {
    model::Settings settings = test::thesis_settings(level, 1e-3);
    settings.impulse.method = ImpulseMethodName::sem;
    test::CubeWorld scene(settings, 0.5, 0.0, 1.5 - test::CubeWorld::sphere_offset(level),
                          Vec3(1, 0, 0));
    double highest = 0.0;
    scene.world.run_until(0.6);
    while (scene.world.time() < 1.0) {
      scene.world.step();
      highest = std::max(highest, scene.position().z());
    }
    EXPECT_LE(scene.velocity().norm(), 1e-9);
    EXPECT_NEAR(highest, 0.5 + test::CubeWorld::sphere_offset(level), 6e-3);
  }
}

TEST(VectorField, HoversAboutOneRangeAboveTheFloor) {
  for (int level = 2; level <= 5; ++level) {
    model::Settings settings = test::thesis_settings(level, 1e-3);
    settings.impulse.method = ImpulseMethodName::vector_field;
    test::CubeWorld scene(settings, 0.5, 0.0, 1.5 - test::CubeWorld::sphere_offset(level));
    scene.world.run_until(6.0);
    const double range = 2.0 * std::ldexp(1.0, 1 - level);
    const double hover = scene.position().z() - 0.5 - test::CubeWorld::sphere_offset(level);
    EXPECT_GT(hover, 0.5 * range) << level;
    EXPECT_LT(hover, range) << level;
    EXPECT_LE(scene.velocity().norm(), 1e-3) << level;
  }
}

}  // namespace
}  // namespace gotai
