// The corrected step bounds (tests/data/golden/timestep.json, errata 28-30).
#include <gtest/gtest.h>

#include "gotai/dynamics/step_control.h"
#include "support/golden.h"

namespace gotai::dynamics {
namespace {

TEST(StepControl, GoldenBounds) {
  const nlohmann::json file = test::golden("timestep.json");
  for (const nlohmann::json& c : file["cases"]) {
    const auto vec3 = [](const nlohmann::json& j) {
      return Vec3(j[0].get<double>(), j[1].get<double>(), j[2].get<double>());
    };
    const Vec3 v = vec3(c["v"]);
    const Vec3 w = vec3(c["omega"]);
    const double rho = c["rho"];
    const double r = c["r"];
    const auto near = [](double actual, const nlohmann::json& expected) {
      if (!expected.is_number()) {  // infinite at rest
        EXPECT_TRUE(std::isinf(actual));
        return;
      }
      EXPECT_NEAR(actual, expected.get<double>(), 1e-12 * std::max(1.0, expected.get<double>()));
    };
    near(speed_bound(v, w, rho), c["vmax_scalar_sum"]);
    near(speed_maximum(v, w, rho), c["vmax_exact"]);
    near(step_bound(r, speed_bound(v, w, rho)), c["dt_scalar_sum"]);
    near(step_bound(r, speed_maximum(v, w, rho)), c["dt_exact"]);
    EXPECT_LE(speed_maximum(v, w, rho), speed_bound(v, w, rho) * (1.0 + 1e-15));
  }
}

model::BodyState falling_body(double speed, double radius) {
  model::BodyState bodies;
  const model::BodyIndex i = model::append_body(bodies);
  bodies.kind[i] = model::BodyKind::dynamic;
  bodies.v_W[i] = Vec3(0, 0, -speed);
  bodies.voxel_radius[i] = radius;
  bodies.bounding_radius[i] = 1.0;
  return bodies;
}

TEST(StepControl, DerivedStepSolvesForItsOwnGravity) {
  model::Settings settings;
  settings.time.max_step = 10.0;
  for (const double speed : {0.0, 0.1, 30.0}) {
    const double dt = derived_step(falling_body(speed, 0.05), settings);
    const double moved = dt * (speed + settings.gravity.norm() * dt);
    EXPECT_NEAR(moved, settings.time.safety * 0.05, 1e-15);
  }
}

TEST(StepControl, DerivedStepIsCappedAndRegularWithoutMotion) {
  model::Settings settings;
  settings.gravity.setZero();
  EXPECT_EQ(derived_step(falling_body(0.0, 0.05), settings), settings.time.max_step);
  EXPECT_EQ(derived_step({}, settings), settings.time.max_step);
}

}  // namespace
}  // namespace gotai::dynamics
