// The constraint method on contacts made by hand, against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "gotai/impulse/assembly.h"
#include "gotai/impulse/islands.h"
#include "support/contact_scene.h"
#include "support/golden.h"

namespace gotai::impulse {
namespace {

using model::SolverName;

Mat3 mat(const nlohmann::json& a) {
  Mat3 m;
  for (int i = 0; i < 3; ++i) m.row(i) = test::vec(a[static_cast<std::size_t>(i)]).transpose();
  return m;
}

nlohmann::json golden_case(const std::string& id) {
  const nlohmann::json file = test::golden("dynamics.json");
  for (const auto& c : file["cases"]) {
    if (c["id"] == id) return c;
  }
  throw std::runtime_error("no golden case " + id);
}

class Constraint : public testing::TestWithParam<SolverName> {
 protected:
  std::unique_ptr<ImpulseMethod> method() const {
    return make_method(test::method_settings(model::ImpulseMethodName::constraint,
                                             model::ContactTreatment::all, GetParam()));
  }
  double tolerance() const { return GetParam() == SolverName::exact ? 1e-11 : 1e-8; }
};

INSTANTIATE_TEST_SUITE_P(Solvers, Constraint,
                         testing::Values(SolverName::exact, SolverName::iterative),
                         [](const auto& p) { return std::string(to_string(p.param)); });

TEST_P(Constraint, EccentricImpactsOfTwoBodies) {
  const nlohmann::json golden = golden_case("eccentric_impact_pair");
  for (const auto& c : golden["expected"]["cases"]) {
    test::ContactScene scene;
    scene.surface(c["e"], 0.0);
    for (std::size_t k = 0; k < 2; ++k) {
      scene.add_body(c["m"][k], mat(c["I"][k]), -test::vec(c["r"][k]), test::vec(c["v"][k]),
                     test::vec(c["w"][k]));
    }
    scene.begin_pair(0, 1);
    scene.add_contact(Vec3::Zero(), test::vec(c["n"]));
    const double energy = scene.kinetic_energy();
    scene.strike(*method(), 1e-3);
    for (model::BodyIndex k = 0; k < 2; ++k) {
      EXPECT_LE((scene.bodies.v_W[k] - test::vec(c["v_after"][k])).norm(), tolerance());
      EXPECT_LE((scene.bodies.w_W[k] - test::vec(c["w_after"][k])).norm(), tolerance());
    }
    EXPECT_NEAR(scene.update.contact_impulse[0].norm(), c["impulse"].get<double>(), tolerance());
    EXPECT_NEAR(scene.kinetic_energy() - energy, c["dE"].get<double>(), 10 * tolerance());
  }
}

TEST_P(Constraint, FlatCubeBouncesAsOneAndSharesTheLoadEvenly) {
  for (const int side : {1, 2, 4, 8, 16}) {
    test::ContactScene scene;
    scene.surface(0.5, 0.3);
    const auto cube = scene.add_body(1.0, test::cube_inertia(1.0, 1.0), Vec3(0, 0, 0.5),
                                     Vec3(0, 0, -1), Vec3::Zero());
    const auto floor =
        scene.add_body(0.0, Mat3::Identity(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero());
    scene.begin_pair(cube, floor);
    for (int i = 0; i < side; ++i) {
      for (int j = 0; j < side; ++j) {
        scene.add_contact(Vec3((i + 0.5) / side - 0.5, (j + 0.5) / side - 0.5, 0), Vec3::UnitZ());
      }
    }
    const model::SolveReport report = scene.strike(*method(), 1e-3);
    EXPECT_LE((scene.bodies.v_W[cube] - Vec3(0, 0, 0.5)).norm(), tolerance()) << side;
    EXPECT_LE(scene.bodies.w_W[cube].norm(), tolerance());
    EXPECT_LE(report.residual, tolerance());
    EXPECT_EQ(report.rows, static_cast<std::uint32_t>(side * side));
    const double share = 1.5 / (side * side);
    for (const Vec3& p : scene.update.contact_impulse) EXPECT_NEAR(p.z(), share, 1e-5 * share);
  }
}

TEST_P(Constraint, LoadIsSharedByArea) {
  test::ContactScene scene;
  scene.surface(0.0, 0.0);
  const auto cube = scene.add_body(1.0, test::cube_inertia(1.0, 1.0), Vec3(0, 0, 0.5),
                                   Vec3(0, 0, -1), Vec3::Zero());
  const auto floor =
      scene.add_body(0.0, Mat3::Identity(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero());
  scene.begin_pair(cube, floor);
  // Two concentric squares: the inner contacts stand for three times the surface.
  for (const double r : {0.2, 0.4}) {
    for (const double x : {-r, r}) {
      for (const double y : {-r, r}) {
        scene.add_contact(Vec3(x, y, 0), Vec3::UnitZ(), 0.0, r < 0.3 ? 3.0 : 1.0);
      }
    }
  }
  scene.strike(*method(), 1e-3);
  for (int i = 0; i < 8; ++i) {
    EXPECT_NEAR(scene.update.contact_impulse[static_cast<std::size_t>(i)].z(),
                i < 4 ? 3.0 / 16.0 : 1.0 / 16.0, 1e-6);
  }
}

TEST_P(Constraint, ObliqueSphereSticksAndRollsOrSlides) {
  // A solid sphere hits the floor with v = (vx, 0, -vz). The contact point slides at vx; sticking
  // takes the tangential impulse 2/7 m vx, friction allows mu (1 + e) m vz.
  const double e = 0.5;
  const double vz = 2.0;
  for (const double mu : {0.1, 0.2, 0.5}) {
    for (const double vx : {0.3, 1.0, 3.0}) {
      test::ContactScene scene;
      scene.surface(e, mu);
      const double R = 0.5;
      const auto sphere = scene.add_body(2.0, Mat3::Identity() * (0.4 * 2.0 * R * R), Vec3(0, 0, R),
                                         Vec3(vx, 0, -vz), Vec3::Zero());
      const auto floor =
          scene.add_body(0.0, Mat3::Identity(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero());
      scene.begin_pair(sphere, floor);
      scene.add_contact(Vec3::Zero(), Vec3::UnitZ());
      scene.strike(*method(), 1e-3);
      const double slowed = std::min(mu * (1 + e) * vz, 2.0 / 7.0 * vx);
      EXPECT_LE((scene.bodies.v_W[sphere] - Vec3(vx - slowed, 0, e * vz)).norm(), tolerance());
      EXPECT_LE((scene.bodies.w_W[sphere] - Vec3(0, slowed * 2.5 / R, 0)).norm(), tolerance());
    }
  }
}

TEST_P(Constraint, SeparatingContactsArePulledAndPushedByNobody) {
  // Erratum 4: A = [[2,-1],[-1,2]]-like; the separating contact must not be driven inward.
  test::ContactScene scene;
  scene.surface(0.5, 0.0);
  const auto body =
      scene.add_body(1.0, Mat3::Identity() / 3.0, Vec3(0, 0, 1), Vec3(0, 0, -0.5), Vec3(0, 1.5, 0));
  const auto floor =
      scene.add_body(0.0, Mat3::Identity(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero());
  scene.begin_pair(body, floor);
  scene.add_contact(Vec3(1, 0, 0), Vec3::UnitZ());   // v = -2
  scene.add_contact(Vec3(-1, 0, 0), Vec3::UnitZ());  // v = +1
  scene.strike(*method(), 1e-3);
  const double right = scene.bodies.v_W[body].z() - scene.bodies.w_W[body].y();
  const double left = scene.bodies.v_W[body].z() + scene.bodies.w_W[body].y();
  EXPECT_GE(right, 1.0 - tolerance());
  EXPECT_GE(left, -tolerance());
}

TEST_P(Constraint, NewtonsCradleFollowsTheLcp) {
  // Erratum 48: three balls, e = 1: -1/3, 2/3, 2/3, not 0, 0, 1.
  test::ContactScene scene;
  scene.surface(1.0, 0.0);
  for (int k = 0; k < 3; ++k) {
    scene.add_body(1.0, Mat3::Identity(), Vec3(k, 0, 0), Vec3(k == 0 ? 1 : 0, 0, 0), Vec3::Zero());
  }
  for (model::BodyIndex k = 0; k < 2; ++k) {
    scene.begin_pair(k, k + 1);
    scene.add_contact(Vec3(k + 0.5, 0, 0), -Vec3::UnitX());
  }
  scene.strike(*method(), 1e-3);
  EXPECT_NEAR(scene.bodies.v_W[0].x(), -1.0 / 3.0, tolerance());
  EXPECT_NEAR(scene.bodies.v_W[1].x(), 2.0 / 3.0, tolerance());
  EXPECT_NEAR(scene.bodies.v_W[2].x(), 2.0 / 3.0, tolerance());
}

TEST_P(Constraint, CatchingABodyAtTheTopOfItsFlightShowsTheBoundOfTheSchemesEnergy) {
  // E = T + U + dt/2 m g.v changes by p (V + v') / 2 in a step: a body that rises at V < g dt and
  // is held (v' = 0, p = m (g dt - V)) gains m V (g dt - V) / 2, at most m (g dt)^2 / 8.
  const double dt = 0.01;
  const double g = 9.8;
  const double m = 2.0;
  double largest = 0.0;
  for (const double fraction : {-0.5, 0.0, 0.25, 0.5, 0.75, 1.0, 1.5}) {
    const double V = fraction * g * dt;
    test::ContactScene scene;
    scene.surface(0.0, 0.0);
    const auto body =
        scene.add_body(m, Mat3::Identity(), Vec3(0, 0, 0.5), Vec3(0, 0, V), Vec3::Zero());
    const auto floor =
        scene.add_body(0.0, Mat3::Identity(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero());
    scene.begin_pair(body, floor);
    scene.add_contact(Vec3::Zero(), Vec3::UnitZ());
    const auto energy = [&](double z) {
      const double v = scene.bodies.v_W[body].z();
      return 0.5 * m * v * v + m * g * z - 0.5 * dt * m * g * v;
    };
    const double before = energy(0.0);
    scene.strike(*method(), dt, Vec3(0, 0, -g * dt));
    const double after = energy(scene.bodies.v_W[body].z() * dt);
    const double p = m * std::max(0.0, g * dt - V);
    EXPECT_NEAR(after - before, 0.5 * p * V, 1e-8) << fraction;
    largest = std::max(largest, after - before);
  }
  EXPECT_NEAR(largest, m * g * dt * g * dt / 8.0, 1e-8);
}

TEST_P(Constraint, SlidingSphereBeginsToRollAtFiveSeventhsOfItsSpeed) {
  // Golden sphere_rolling_onset. Each step takes mu g dt from the speed and adds its moment to the
  // spin, until the contact point stands still; then it rolls for ever.
  const nlohmann::json golden = golden_case("sphere_rolling_onset");
  const auto& in = golden["inputs"];
  const double R = in["R"];
  const double mu = in["mu"];
  const double g = in["g"];
  const double dt = 1e-3;
  test::ContactScene scene;
  scene.surface(0.0, mu);
  const auto ball = scene.add_body(1.0, Mat3::Identity() * (0.4 * R * R), Vec3(0, 0, R),
                                   test::vec(in["v0"]), Vec3::Zero());
  const auto floor =
      scene.add_body(0.0, Mat3::Identity(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero());
  scene.begin_pair(ball, floor);
  scene.add_contact(Vec3::Zero(), Vec3::UnitZ());
  const auto solver = method();
  const auto slip = [&] { return scene.bodies.v_W[ball].x() - R * scene.bodies.w_W[ball].y(); };
  double distance = 0.0;
  double rolling_since = -1.0;
  double distance_at_onset = 0.0;
  for (int step = 1; step <= 1000; ++step) {
    scene.strike(*solver, dt, Vec3(0, 0, -g * dt));
    distance += scene.bodies.v_W[ball].x() * dt;
    if (rolling_since < 0.0 && slip() < 1e-9) {
      rolling_since = step * dt;
      distance_at_onset = distance;
    }
  }
  const auto& expected = golden["expected"];
  EXPECT_NEAR(rolling_since, expected["t_roll"].get<double>(), 1.01 * dt);
  EXPECT_NEAR(scene.bodies.v_W[ball].x(), expected["v_roll"].get<double>(), 1e-6);
  EXPECT_NEAR(scene.bodies.w_W[ball].y(), expected["omega_roll"].get<double>(), 1e-6);
  EXPECT_NEAR(distance_at_onset, expected["distance"].get<double>(), 4.0 * 2 * dt);
  EXPECT_LE(std::abs(slip()), 1e-7);
}

TEST(Plastic, ABodyBetweenTwoWallsCannotBounceAndIsCounted) {
  // It touches both: the wall that it hits asks for v' <= -e v, the other one for v' >= 0.
  for (const double friction : {0.0, 0.5}) {
    for (const double e : {0.0, 0.5}) {
      test::ContactScene scene;
      scene.surface(e, friction);
      const auto body =
          scene.add_body(1.0, Mat3::Identity(), Vec3::Zero(), Vec3(1, 0, 0), Vec3::Zero());
      const auto walls =
          scene.add_body(0.0, Mat3::Identity(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero());
      scene.begin_pair(body, walls);
      scene.add_contact(Vec3(-0.5, 0, 0), Vec3::UnitX());
      scene.add_contact(Vec3(0.5, 0, 0), -Vec3::UnitX());
      const model::SolveReport report = scene.strike(
          *make_method(test::method_settings(model::ImpulseMethodName::constraint,
                                             model::ContactTreatment::all, SolverName::exact)),
          1e-3);
      EXPECT_EQ(report.plastic_islands, e > 0.0 ? 1U : 0U) << e << " " << friction;
      EXPECT_LE(report.residual, 1e-8);
      EXPECT_LE(scene.bodies.v_W[body].norm(), 1e-8);
    }
  }
}

TEST(Assembly, RowBiasFollowsTheGap) {
  // touching: e of the approach before gravity, nothing for separating contacts
  EXPECT_DOUBLE_EQ(row_bias(-2.0, -2.1, 0.0, 0.5, 0.01, 9.8), -1.0);
  EXPECT_DOUBLE_EQ(row_bias(1.0, 0.9, -0.1, 0.5, 0.01, 9.8), 0.0);
  // ahead: reaches the gap within the step fast -> bounces; slowly -> lands at gap 0
  EXPECT_DOUBLE_EQ(row_bias(-2.0, -2.1, 0.01, 0.5, 0.01, 9.8), -1.0);
  EXPECT_DOUBLE_EQ(row_bias(-0.1, -0.2, 0.001, 0.5, 0.01, 9.8), 0.1);
  EXPECT_DOUBLE_EQ(row_bias(-2.0, -2.1, 0.01, 0.0, 0.01, 9.8), 1.0);
  // ahead and not reached: may close what there is
  EXPECT_DOUBLE_EQ(row_bias(-2.0, -2.1, 0.1, 0.5, 0.01, 9.8), 10.0);
}

TEST(Islands, ConnectThroughDynamicBodiesOnly) {
  test::ContactScene scene;
  const auto floor =
      scene.add_body(0.0, Mat3::Identity(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero());
  for (int k = 0; k < 5; ++k) {
    scene.add_body(1.0, Mat3::Identity(), Vec3(k, 0, 0), Vec3::Zero(), Vec3::Zero());
  }
  for (const auto& [a, b] : {std::pair{1U, 3U}, {1U, floor}, {2U, floor}, {3U, 5U}, {4U, floor}}) {
    scene.begin_pair(a, b);
    scene.add_contact(Vec3::Zero(), Vec3::UnitZ());
  }
  std::vector<Island> islands(1, {{7}, {8}});  // storage of an earlier step
  find_islands(scene.bodies, scene.contacts, islands);
  ASSERT_EQ(islands.size(), 3U);
  EXPECT_EQ(islands[0].bodies, (std::vector<model::BodyIndex>{1, 3, 5}));
  EXPECT_EQ(islands[0].pairs, (std::vector<std::uint32_t>{0, 1, 3}));
  EXPECT_EQ(islands[1].bodies, (std::vector<model::BodyIndex>{2}));
  EXPECT_EQ(islands[2].bodies, (std::vector<model::BodyIndex>{4}));
}

}  // namespace
}  // namespace gotai::impulse
