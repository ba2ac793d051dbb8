// What each impulse method promises, on contacts made by hand.
#include <gtest/gtest.h>

#include <numbers>

#include "gotai/core/error.h"
#include "gotai/core/random.h"
#include "gotai/impulse/penalty_method.h"
#include "gotai/impulse/spring_forces.h"
#include "support/contact_scene.h"
#include "support/golden.h"

namespace gotai::impulse {
namespace {

using model::ContactTreatment;
using model::ImpulseMethodName;

constexpr double dt = 1e-3;

// A ball of radius 1 and 1 kg touching the floor.
test::ContactScene ball_on_floor(double restitution, double friction, const Vec3& v) {
  test::ContactScene scene;
  scene.surface(restitution, friction);
  const auto ball = scene.add_body(1.0, Mat3::Identity() * 0.4, Vec3(0, 0, 1), v, Vec3::Zero());
  scene.bodies.bounding_radius[ball] = 1.0;
  const auto floor =
      scene.add_body(0.0, Mat3::Identity(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero());
  scene.begin_pair(ball, floor);
  scene.add_contact(Vec3::Zero(), Vec3::UnitZ());
  return scene;
}

TEST(Methods, OneCentralContactBouncesWithRestitution) {
  for (const auto method : {ImpulseMethodName::constraint, ImpulseMethodName::impulse,
                            ImpulseMethodName::impulse_averaged}) {
    test::ContactScene scene = ball_on_floor(0.6, 0.0, Vec3(0, 0, -2));
    scene.strike(*make_method(test::method_settings(method)), dt);
    EXPECT_NEAR(scene.bodies.v_W[0].z(), 1.2, 1e-12) << to_string(method);
  }
  test::ContactScene scene = ball_on_floor(0.6, 0.0, Vec3(0, 0, -2));
  scene.strike(*make_method(test::method_settings(ImpulseMethodName::constraint,
                                                  ContactTreatment::apparent)),
               dt);
  EXPECT_NEAR(scene.bodies.v_W[0].z(), 1.2, 1e-12);
}

TEST(Methods, SemSticksInAllDirections) {
  test::ContactScene scene = ball_on_floor(0.6, 0.1, Vec3(3, 1, -2));
  scene.strike(*make_method(test::method_settings(ImpulseMethodName::sem)), dt);
  const Vec3 at_contact = scene.bodies.v_W[0] + scene.bodies.w_W[0].cross(Vec3(0, 0, -1));
  EXPECT_LE(at_contact.norm(), 1e-11);
}

TEST(Methods, SemMinimisesTheEnergyOverTheImpulses) {
  // (4.1)-(4.5): every other impulse with p_n >= 0 leaves more kinetic energy.
  test::ContactScene start = ball_on_floor(0.6, 0.1, Vec3(3, 1, -2));
  test::ContactScene scene = start;
  scene.strike(*make_method(test::method_settings(ImpulseMethodName::sem)), dt);
  const double least = scene.kinetic_energy();
  Random random(3);
  for (int trial = 0; trial < 100; ++trial) {
    const Vec3 p = scene.update.contact_impulse[0] + 0.1 * random.unit_vector();
    test::ContactScene other = start;
    other.set_velocity(0, other.bodies.v_W[0] + p,
                       other.bodies.w_W[0] + other.bodies.inverse_I_W[0] * Vec3(0, 0, -1).cross(p));
    EXPECT_GE(other.kinetic_energy(), least);
  }
}

TEST(Methods, SeparatingContactsAreLeftAlone) {
  for (const auto method : {ImpulseMethodName::constraint, ImpulseMethodName::impulse,
                            ImpulseMethodName::impulse_averaged, ImpulseMethodName::penalty}) {
    test::ContactScene scene = ball_on_floor(0.6, 0.5, Vec3(1, 0, 0.5));
    scene.strike(*make_method(test::method_settings(method)), dt);
    EXPECT_EQ(scene.bodies.v_W[0], Vec3(1, 0, 0.5)) << to_string(method);
  }
}

TEST(Methods, FrictionNeverReversesSliding) {
  for (const auto& [method, contacts] :
       {std::pair{ImpulseMethodName::constraint, ContactTreatment::all},
        {ImpulseMethodName::constraint, ContactTreatment::apparent},
        {ImpulseMethodName::impulse, ContactTreatment::all},
        {ImpulseMethodName::impulse_averaged, ContactTreatment::all},
        {ImpulseMethodName::sem, ContactTreatment::all}}) {
    test::ContactScene scene = ball_on_floor(0.0, 10.0, Vec3(1e-3, 0, -2));
    scene.strike(*make_method(test::method_settings(method, contacts)), dt);
    const double slip = scene.bodies.v_W[0].x() - scene.bodies.w_W[0].y();
    EXPECT_NEAR(slip, 0.0, 1e-12) << to_string(method) << " " << to_string(contacts);
  }
}

TEST(Methods, AveragedImpulsesStillApproachOffCentre) {
  // Erratum 18: two contacts at x = +-1 of a body with I = 1/3: each sees 1 + 3 times 1/m.
  test::ContactScene scene;
  scene.surface(0.5, 0.0);
  scene.add_body(1.0, Mat3::Identity() / 3.0, Vec3::Zero(), Vec3(0, 0, -1), Vec3::Zero());
  scene.add_body(0.0, Mat3::Identity(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero());
  scene.begin_pair(0, 1);
  scene.add_contact(Vec3(1, 0, 0), Vec3::UnitZ());
  scene.add_contact(Vec3(-1, 0, 0), Vec3::UnitZ());
  test::ContactScene superposed = scene;
  scene.strike(*make_method(test::method_settings(ImpulseMethodName::impulse_averaged)), dt);
  EXPECT_NEAR(scene.bodies.v_W[0].z(), -1.0 + 1.5 / 4.0, 1e-12);
  superposed.strike(*make_method(test::method_settings(ImpulseMethodName::impulse)), dt);
  EXPECT_NEAR(superposed.bodies.v_W[0].z(), -1.0 + 2 * 1.5 / 4.0, 1e-12);
}

TEST(Penalty, DampingRatioGivesTheRestitutionOfEquation22) {
  for (const auto& c : {0.1, 0.35, 0.7, 0.95}) {
    const double zeta = damping_ratio(c);
    // (2.2) with c = 2 zeta sqrt(m k): e = exp(-2 zeta sqrt(mk) pi / sqrt(4mk(1 - zeta^2))).
    EXPECT_NEAR(std::exp(-zeta * std::numbers::pi / std::sqrt(1 - zeta * zeta)), c, 1e-14);
  }
  EXPECT_EQ(damping_ratio(0.0), 1.0);
  EXPECT_NEAR(damping_ratio(1.0), 0.0, 1e-15);
}

// Lets the spring of one pair act without gravity from first touch to separation; returns -v'/v.
double spring_restitution(double k, double c, int contacts, bool tension, bool divided) {
  test::ContactScene scene = ball_on_floor(0.0, 0.0, Vec3(0, 0, -1));
  for (int i = 1; i < contacts; ++i) scene.add_contact(Vec3::Zero(), Vec3::UnitZ());
  PairSpring spring;
  const double n = divided ? 1.0 : contacts;
  spring.frequency = std::sqrt(n * k);
  spring.damping_ratio = n * c / (2 * spring.frequency);
  spring.tension = tension;
  const double h = 1e-5;
  double z = 0.0;
  std::vector<double> normal_impulse(scene.contacts.size());
  WorkingVelocities before;
  WorkingVelocities velocities;
  for (int step = 0; step < 200000; ++step) {
    std::vector<Vec3> impulse(scene.contacts.size(), Vec3::Zero());
    before.read(scene.bodies);
    velocities.read(scene.bodies);
    add_spring_impulses(scene.bodies, scene.contacts, scene.contacts.pairs[0], spring,
                        std::vector<double>(scene.contacts.size(), z), h, before, velocities,
                        normal_impulse, impulse);
    scene.set_velocity(0, velocities.v_W[0], Vec3::Zero());
    z += velocities.v_W[0].z() * h;
    if (z > 0.0) break;
  }
  return scene.bodies.v_W[0].z();
}

TEST(Penalty, GoldenRestitutionsWithAndWithoutTension) {
  const nlohmann::json file = test::golden("dynamics.json");
  for (const auto& golden : file["cases"]) {
    if (golden["id"] != "penalty_restitution") continue;
    for (const auto& c : golden["expected"]["cases"]) {
      const double k = c["k"];
      const double damper = c["c"];
      EXPECT_NEAR(spring_restitution(k, damper, 1, true, true), c["e_eq22"].get<double>(), 1e-3);
      EXPECT_NEAR(spring_restitution(k, damper, 1, false, true),
                  c["e_release_at_zero_force"].get<double>(), 1e-3);
      EXPECT_NEAR(spring_restitution(k, damper, 4, true, false), c["n4_contacts_e"].get<double>(),
                  1e-3);
      // Divided by the contacts it does not depend on their number.
      EXPECT_NEAR(spring_restitution(k, damper, 4, true, true), c["e_eq22"].get<double>(), 1e-3);
    }
  }
}

TEST(Methods, PlanAStepOfNoTime) {
  // The energy before the first step is measured with one.
  const test::ContactScene scene = ball_on_floor(0.6, 0.1, Vec3::Zero());
  for (const auto method : {ImpulseMethodName::penalty, ImpulseMethodName::vector_field}) {
    const auto plan = make_method(test::method_settings(method))->plan(scene.bodies, 0.0);
    EXPECT_EQ(plan.substeps, 1) << to_string(method);
    EXPECT_EQ(plan.substep_dt(), 0.0);
  }
}

TEST(MakeMethod, RefusesApparentContactsForOtherMethods) {
  const model::Settings settings =
      test::method_settings(ImpulseMethodName::penalty, ContactTreatment::apparent);
  try {
    make_method(settings);
    FAIL() << "expected an error";
  } catch (const InvalidArgument& error) {
    EXPECT_NE(std::string(error.what()).find("impulse.contacts"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("constraint"), std::string::npos);
  }
}

}  // namespace
}  // namespace gotai::impulse
