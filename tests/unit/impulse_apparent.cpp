// The apparent contact point (Makino 2007, chapter 5) against the golden cases, and what it
// guarantees: no pair gains energy.
#include <gtest/gtest.h>

#include "gotai/core/random.h"
#include "gotai/impulse/apparent_contact.h"
#include "gotai/impulse/contact_kinematics.h"
#include "support/contact_scene.h"
#include "support/golden.h"

namespace gotai::impulse {
namespace {

model::Settings apparent_settings() {
  return test::method_settings(model::ImpulseMethodName::constraint,
                               model::ContactTreatment::apparent);
}

// The body, the floor and the contacts of a golden case; the body's velocity is chosen so that the
// contacts approach as the case says, if one can be.
struct GoldenScene {
  test::ContactScene scene;
  bool velocity_found = false;

  explicit GoldenScene(const nlohmann::json& golden) {
    Mat3 inertia;
    for (int i = 0; i < 3; ++i) {
      inertia.row(i) = test::vec(golden["inertia"][static_cast<std::size_t>(i)]).transpose();
    }
    const auto n = static_cast<Eigen::Index>(golden["r"].size());
    Eigen::MatrixXd J(n, 6);
    Eigen::VectorXd v(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const Vec3 normal = test::vec(golden["n"][at]);
      J.row(i) << normal.transpose(), test::vec(golden["r"][at]).cross(normal).transpose();
      v[i] = golden["v"][at].get<double>();
    }
    const Eigen::VectorXd twist = J.completeOrthogonalDecomposition().solve(v);
    velocity_found = (J * twist - v).norm() < 1e-12;
    scene.surface(golden["e"], 0.0);
    scene.add_body(golden["mass"], inertia, Vec3::Zero(), twist.head<3>(), twist.tail<3>());
    scene.add_body(0.0, Mat3::Identity(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero());
    scene.begin_pair(0, 1);
    for (std::size_t i = 0; i < golden["r"].size(); ++i) {
      scene.add_contact(test::vec(golden["r"][i]), test::vec(golden["n"][i]));
    }
  }
};

TEST(Apparent, GoldenPointsNormalsAndImpulses) {
  const nlohmann::json file = test::golden("apparent.json");
  int with_impulse = 0;
  for (const auto& golden : file["cases"]) {
    SCOPED_TRACE(golden["name"].get<std::string>());
    std::vector<Vec3> points;
    std::vector<Vec3> normals;
    std::vector<double> approach;
    for (std::size_t i = 0; i < golden["r"].size(); ++i) {
      points.push_back(test::vec(golden["r"][i]));
      normals.push_back(test::vec(golden["n"][i]));
      approach.push_back(golden["v"][i]);
    }
    const ApparentContact apparent = apparent_contact(points, normals, approach);
    const auto& expected = golden["expected"];
    if (!expected.contains("r_a")) {
      if (!expected.contains("sum_w")) {
        EXPECT_TRUE(!apparent.exists || apparent.weighted_normal < 1e-12);
      }
      continue;
    }
    EXPECT_LE((apparent.point - test::vec(expected["r_a"])).norm(), 1e-12);
    EXPECT_NEAR(apparent.weight_sum, expected["sum_w"].get<double>(), 1e-12);
    EXPECT_NEAR(apparent.weighted_normal, expected["norm_sum_wn"].get<double>(), 1e-12);
    if (expected.contains("n_a") && !expected["n_a"].is_null()) {
      EXPECT_LE((apparent.normal - test::vec(expected["n_a"])).norm(), 1e-12);
    }
    if (!expected.contains("p_a")) continue;

    GoldenScene gold(golden);
    ASSERT_TRUE(gold.velocity_found);
    EXPECT_NEAR(inverse_effective_mass(gold.scene.bodies, gold.scene.contacts.pairs[0],
                                       apparent.point, apparent.normal),
                expected["A_a"].get<double>(), 1e-12 * expected["A_a"].get<double>());
    gold.scene.strike(*make_method(apparent_settings()), 1e-3);
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_NEAR(gold.scene.update.contact_impulse[i].dot(normals[i]),
                  expected["p_i"][i].get<double>(), 1e-12 * (1 + expected["p_a"].get<double>()));
    }
    ++with_impulse;
  }
  EXPECT_GE(with_impulse, 6);
}

// A random pair of bodies with random contacts, moving at random.
test::ContactScene random_pair(Random& random, double restitution, double friction) {
  test::ContactScene scene;
  scene.surface(restitution, friction);
  for (int k = 0; k < 2; ++k) {
    const double mass = std::pow(10.0, random.uniform(-1, 1));
    const Mat3 axes = random.rotation().toRotationMatrix();
    Vec3 moments(random.uniform(0.1, 1), random.uniform(0.1, 1), random.uniform(0.1, 1));
    moments *= 0.2 * mass;
    scene.add_body(k == 1 && random.uniform() < 0.3 ? 0.0 : mass,
                   axes * moments.asDiagonal() * axes.transpose(), Vec3(0, 0, k == 0 ? 0.5 : -0.5),
                   random.unit_vector() * 2 * random.uniform(),
                   random.unit_vector() * 4 * random.uniform());
  }
  scene.begin_pair(0, 1);
  const int contacts = 1 + static_cast<int>(random.next_u32() % 12);
  for (int i = 0; i < contacts; ++i) {
    Vec3 normal = random.unit_vector();
    if (normal.z() < -0.2) normal = -normal;
    scene.add_contact(
        Vec3(random.uniform(-.5, .5), random.uniform(-.5, .5), random.uniform(-.1, .1)), normal);
  }
  return scene;
}

TEST(Apparent, EnergyNeverGrowsIn10000RandomPairs) {
  Random random(5);
  double worst = 0.0;
  for (int trial = 0; trial < 10000; ++trial) {
    const double restitution = random.uniform();
    const double friction = trial % 2 == 0 ? 0.0 : random.uniform();
    test::ContactScene scene = random_pair(random, restitution, friction);
    const double before = scene.kinetic_energy();
    scene.strike(*make_method(apparent_settings()), 1e-3);
    const double gain = scene.kinetic_energy() / before - 1.0;
    worst = std::max(worst, gain);
    ASSERT_LE(gain, 1e-12) << trial;
  }
  RecordProperty("worst_gain", std::to_string(worst));
}

TEST(Apparent, MomentumIsConservedBetweenTwoBodies) {
  Random random(6);
  for (int trial = 0; trial < 200; ++trial) {
    test::ContactScene scene = random_pair(random, 0.5, 0.5);
    if (!scene.bodies.is_dynamic(1)) continue;
    const auto momentum = [&] {
      Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
      for (model::BodyIndex i = 0; i < 2; ++i) {
        const Vec3 p = scene.bodies.v_W[i] / scene.bodies.inverse_mass[i];
        sum.head<3>() += p;
        sum.tail<3>() += scene.bodies.x_W[i].cross(p) + scene.bodies.L_W[i];
      }
      return sum;
    };
    const auto before = momentum();
    scene.strike(*make_method(apparent_settings()), 1e-3);
    EXPECT_LE((momentum() - before).norm(), 1e-12 * (1 + before.norm()));
  }
}

TEST(Apparent, EveryFaceOfAContainerHasAPointOfItsOwn) {
  // A cube flies into the corner of a floor and a wall, e = 0: one apparent contact for both would
  // push along the mean of all normals and leave it moving; one for each stops it.
  for (const bool one_body : {true, false}) {
    test::ContactScene scene;
    scene.surface(0.0, 0.0);
    const auto cube = scene.add_body(1.0, test::cube_inertia(1.0, 1.0), Vec3::Zero(),
                                     Vec3(-1, 0, -2), Vec3::Zero());
    const auto box =
        scene.add_body(0.0, Mat3::Identity(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero());
    if (one_body) scene.bodies.geometry[box] = model::Geometry::container;
    scene.begin_pair(cube, box);
    for (const double t : {-0.4, 0.4}) {
      for (const double u : {-0.4, 0.4}) {
        scene.add_contact(Vec3(t, u, -0.5), Vec3::UnitZ());
      }
    }
    for (const double u : {-0.4, 0.4}) {
      scene.add_contact(Vec3(-0.5, u, 0), Vec3::UnitX());
      scene.contacts.feature.back() |= model::FeatureKey{1} << 32U;
    }
    const model::SolveReport report =
        scene.strike(*make_method(test::method_settings(model::ImpulseMethodName::constraint,
                                                        model::ContactTreatment::apparent,
                                                        model::SolverName::exact)),
                     1e-3);
    EXPECT_EQ(report.rows, one_body ? 2U : 1U);
    if (one_body) {
      EXPECT_LE(scene.bodies.v_W[cube].norm(), 1e-10);
    } else {
      EXPECT_GE(scene.bodies.v_W[cube].norm(), 0.1);
    }
  }
}

// Fig. 5-5: one contact at the apparent point, not spread back, cannot slow a body that spins about
// the normal. Exists only here.
TEST(Apparent, WithoutSpreadingBackASpinningCubeSpinsForEver) {
  test::ContactScene scene;
  scene.surface(0.0, 0.3);
  const auto cube = scene.add_body(1.0, test::cube_inertia(1.0, 1.0), Vec3(0, 0, 0.5), Vec3::Zero(),
                                   Vec3(0, 0, 10));
  const auto floor =
      scene.add_body(0.0, Mat3::Identity(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero());
  scene.begin_pair(cube, floor);
  scene.add_contact(Vec3::Zero(), Vec3::UnitZ());  // the apparent point of a flat face
  const auto method = make_method(test::method_settings());
  for (int step = 0; step < 2000; ++step) {
    scene.strike(*method, 1e-3, Vec3(0, 0, -9.8e-3));
  }
  EXPECT_NEAR(scene.bodies.w_W[cube].z(), 10.0, 1e-12);
}

}  // namespace
}  // namespace gotai::impulse
