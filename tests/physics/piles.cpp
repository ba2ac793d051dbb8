// Piles at rest and scenes that show where a method ends. `bench_impulse rest` runs them for 60 s.
#include <gtest/gtest.h>

#include <cstdio>

#include "gotai/core/random.h"
#include "support/golden.h"
#include "support/worlds.h"

namespace gotai {
namespace {

using model::ContactTreatment;
using model::ImpulseMethodName;
using model::SolverName;

struct Method {
  ImpulseMethodName name;
  ContactTreatment contacts;
  SolverName solver;
  double allowed_gain;  // [J], of about 40 J
  bool rests;           // or rocks and sinks for ever, slower and slower
};

class RestingPile : public testing::TestWithParam<Method> {};

INSTANTIATE_TEST_SUITE_P(
    Methods, RestingPile,
    testing::Values(
        Method{ImpulseMethodName::constraint, ContactTreatment::all, SolverName::exact, 1e-9, true},
        Method{ImpulseMethodName::constraint, ContactTreatment::all, SolverName::iterative, 1e-6,
               true},
        Method{ImpulseMethodName::constraint, ContactTreatment::apparent, SolverName::exact, 1e-9,
               false},
        Method{ImpulseMethodName::impulse_averaged, ContactTreatment::all, SolverName::exact, 1e-9,
               false},
        Method{ImpulseMethodName::penalty, ContactTreatment::all, SolverName::exact, 1e-9, true},
        Method{ImpulseMethodName::sem, ContactTreatment::all, SolverName::exact, 1e-9, true},
        Method{ImpulseMethodName::vector_field, ContactTreatment::all, SolverName::exact, 1e-7,
               true}));

double fastest_body(const World& world) {
  double fastest = 0.0;
  for (const Vec3& v : world.bodies().v_W) fastest = std::max(fastest, v.norm());
  return fastest;
}

TEST_P(RestingPile, GainsNoEnergy) {
  model::Settings settings = test::thesis_settings(4, 0.01);
  settings.impulse.method = GetParam().name;
  settings.impulse.contacts = GetParam().contacts;
  settings.impulse.solver = GetParam().solver;
  World world(settings);
  world.set_default_material(test::surface_material(0.3, 0.5));
  BodyDescription body;
  body.shape = world.add_shape(test::make_generated("hexapod", 5));
  body.mass = 1.0;
  Random random(2);  // with 1 and clang, penalty springs rock the pile for 200 s
  for (int i = 0; i < 4; ++i) {
    body.com_position =
        2.0 * Vec3(random.uniform(-.15, .15), random.uniform(-.15, .15), 0.7 + 1.05 * i);
    body.X_WM.q = random.rotation();
    world.add_body(body);
  }
  world.add_plane({});
  // Springs give back what they stored until the pile is at rest. When that is depends on the
  // compiler's rounding.
  constexpr double kAtRest = 1e-5;
  const double longest = GetParam().rests ? 60.0 : 20.0;
  world.run_until(10.0);
  while (world.time() < longest && fastest_body(world) > kAtRest) world.step();
  if (GetParam().rests) {
    ASSERT_LE(fastest_body(world), kAtRest) << "after " << world.time() << " s";
  }
  const double start_time = world.time();
  const double start = world.energy().total();
  double gain = 0.0;
  while (world.time() < start_time + 3.0) {
    world.step();
    gain = std::max(gain, world.energy().total() - start);
  }
  std::printf("at rest after %.1f s, then gains %.1e J\n", start_time, gain);
  EXPECT_LE(gain, GetParam().allowed_gain);
}

// A stack of three cubes stands with all contacts and falls over with apparent ones (erratum 42).
double worst_tilt(ContactTreatment contacts) {
  model::Settings settings = test::thesis_settings(3, 0.01);
  settings.impulse.contacts = contacts;
  World world(settings);
  world.set_default_material(test::surface_material(0.0, 0.5));
  BodyDescription body;
  body.shape = world.add_shape(test::make_generated("cube", 3));
  body.mass = 1.0;
  const double offset = test::CubeWorld::sphere_offset(3);
  for (int k = 0; k < 3; ++k) {
    // A shift of a fraction of a voxel; spheres of two faces meet later than sphere and plane.
    body.com_position = Vec3(0.03 * k, 0, 0.5 + offset + k * (1.0 + 2.0 * offset));
    world.add_body(body);
  }
  world.add_plane({});
  world.run_until(2.0);
  double worst = 0.0;
  for (model::BodyIndex i = 0; i < 3; ++i) {
    worst = std::max(worst, world.bodies().q_WB[i].angularDistance(Quat::Identity()));
  }
  return worst * 180.0 / M_PI;
}

TEST(Stack, StandsWithAllContactsAndTiltsWithApparentOnes) {
  EXPECT_LE(worst_tilt(ContactTreatment::all), 1.0);
  EXPECT_GE(worst_tilt(ContactTreatment::apparent), 3.0);
}

// Four hexapods that fall on each other: centres of mass every 1/50 s over one second.
std::vector<Vec3> falling_centres(std::uint64_t seed, double dt, ContactTreatment contacts) {
  static const auto shape = test::make_generated("hexapod", 7);
  const double extent = shape->pyramid.grid.voxel_edge(1);
  model::Settings settings = test::thesis_settings(5, dt);
  settings.impulse.contacts = contacts;
  World world(settings);
  world.set_default_material(test::surface_material(0.3, 0.3));
  BodyDescription body;
  body.shape = world.add_shape(shape);
  body.mass = 1.0;
  Random random(seed);
  for (int i = 0; i < 4; ++i) {
    const double x = random.uniform(-0.15, 0.15);
    const double y = random.uniform(-0.15, 0.15);
    body.com_position = extent * Vec3(x, y, 0.7 + 1.05 * i);
    body.X_WM.q = random.rotation();
    random.unit_vector();  // the experiment's perturbation
    world.add_body(body);
  }
  world.add_plane({});
  std::vector<Vec3> centres;
  for (int k = 1; k <= 50; ++k) {
    world.run_until(k / 50.0);
    for (model::BodyIndex i = 0; i < 4; ++i) centres.push_back(world.bodies().x_W[i] / extent);
  }
  return centres;
}

TEST(PileError, ApparentContactsStayAsNearToAllContactsAsErratum47Says) {
  // Definition pile-error: against all contacts at dt = 1/1000, median over 8 seeds, in extents.
  std::vector<double> errors;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const auto reference = falling_centres(seed, 1e-3, ContactTreatment::all);
    const auto apparent = falling_centres(seed, 1e-2, ContactTreatment::apparent);
    double sum = 0.0;
    for (std::size_t k = 0; k < reference.size(); ++k) sum += (apparent[k] - reference[k]).norm();
    errors.push_back(sum / static_cast<double>(reference.size()));
  }
  std::sort(errors.begin(), errors.end());
  const double median = 0.5 * (errors[3] + errors[4]);
  RecordProperty("median_error", std::to_string(median));
  EXPECT_LE(median, 0.038);
}

TEST(Bounce, BallFollowsTheGoldenBounces) {
  // One voxel sphere (level 1) of the cube's ball: heights above its own level's rest height.
  const nlohmann::json file = test::golden("dynamics.json");
  for (const auto& golden : file["cases"]) {
    if (golden["id"] != "bouncing_ball") continue;
    const double dt = 1e-4;
    test::CubeWorld scene(test::thesis_settings(1, dt), golden["inputs"]["e"], 0.0, 1.5);
    const double rest = 0.5 + test::CubeWorld::sphere_offset(1);
    std::vector<double> impacts;
    std::vector<double> apexes;
    double last_speed = 0.0;
    while (impacts.size() < 6) {
      scene.world.step();
      const double speed = scene.velocity().z();
      if (last_speed < 0.0 && speed > 0.0) impacts.push_back(scene.world.time());
      if (last_speed > 0.0 && speed <= 0.0) apexes.push_back(scene.position().z() - rest + 0.5);
      last_speed = speed;
    }
    const auto& expected = golden["expected"];
    for (std::size_t k = 0; k < impacts.size(); ++k) {
      EXPECT_NEAR(impacts[k], expected["impact_times"][k].get<double>(),
                  2.0 * static_cast<double>(k + 1) * dt);
    }
    for (std::size_t k = 0; k < apexes.size(); ++k) {
      EXPECT_NEAR(apexes[k], expected["apex_com_z"][k].get<double>(), 2.0 * 6.0 * dt);
    }
  }
}

}  // namespace
}  // namespace gotai
