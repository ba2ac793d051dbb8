// Golden quaternion updates and torque-free tops (tests/data/golden/{quaternion,dynamics}.json).
#include <gmock/gmock.h>

#include <cmath>

#include "gotai/core/random.h"
#include "gotai/dynamics/integrate.h"
#include "gotai/dynamics/rotation.h"
#include "support/golden.h"

namespace gotai {
namespace {

double number(const nlohmann::json& j, std::size_t k) { return j[k].get<double>(); }
Vec3 vec3(const nlohmann::json& j) { return {number(j, 0), number(j, 1), number(j, 2)}; }
Quat quat(const nlohmann::json& j) {
  return {number(j, 0), number(j, 1), number(j, 2), number(j, 3)};
}
Mat3 mat3(const nlohmann::json& j) {
  Mat3 m;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      m(r, c) = number(j[static_cast<std::size_t>(r)], static_cast<std::size_t>(c));
  return m;
}
/// Angle between two orientations [rad]; by the sine, which is accurate near zero.
double angle_between(const Quat& a, const Quat& b) {
  const Quat turn = a.conjugate() * b;
  return 2.0 * std::asin(std::min(1.0, turn.vec().norm()));
}

model::BodyState one_body(const Mat3& I_B, const Quat& q_WB, const Vec3& w_W) {
  model::BodyState bodies;
  const model::BodyIndex i = model::append_body(bodies);
  bodies.kind[i] = model::BodyKind::dynamic;
  bodies.q_WB[i] = q_WB;
  model::set_mass(bodies, i, 1.0, I_B);
  bodies.L_W[i] = model::angular_momentum(bodies, i, w_W);
  model::refresh_derived(bodies, i);
  return bodies;
}

TEST(Rotation, GoldenQuaternionUpdates) {
  const nlohmann::json file = test::golden("quaternion.json");
  for (const nlohmann::json& c : file["cases"]) {
    const Vec3 w = vec3(c["omega"]);
    const double dt = c["dt"];
    const Quat q = quat(c["q"]);
    EXPECT_LT((dynamics::rotation_increment(w, dt).coeffs() - quat(c["dq"]).coeffs()).norm(),
              1e-13);
    const Quat next = dynamics::rotate(q, w, dt);
    EXPECT_LT((next.coeffs() - quat(c["q_next"]).coeffs()).norm(), 1e-13);
    EXPECT_LT((next.toRotationMatrix() - mat3(c["R_next"])).norm(), 1e-13);
    const Mat3 R = next.toRotationMatrix();
    EXPECT_LT((R * mat3(c["I_body"]) * R.transpose() - mat3(c["I_world_next"])).norm(), 1e-13);
  }
}

TEST(Rotation, IncrementIsSmoothThroughZeroSpin) {
  for (const double w : {1e-3, 1e-5, 1e-9, 0.0}) {
    const Quat dq = dynamics::rotation_increment(Vec3(0, w, 0), 0.01);
    EXPECT_NEAR(dq.norm(), 1.0, 1e-15);
    EXPECT_NEAR(dq.y(), 0.5 * 0.01 * w, 1e-16);
  }
}

TEST(Rotation, SeriesOfSmallAnglesIsExact) {
  for (int k = 0; k < 300; ++k) {
    const double x = 1e-3 * k;
    const auto [cosine, sinc] = dynamics::cosine_and_sinc(x * x);
    EXPECT_NEAR(cosine, std::cos(x), 3e-16) << x;
    EXPECT_NEAR(sinc, x == 0.0 ? 1.0 : std::sin(x) / x, 3e-16) << x;
  }
}

TEST(TorqueFree, SymmetricTopIsExact) {
  const nlohmann::json file = test::golden("dynamics.json");
  for (const nlohmann::json& c : file["cases"]) {
    if (c["id"] != "torque_free_symmetric") continue;
    const nlohmann::json& expected = c["expected"];
    const Vec3 w0 = vec3(c["inputs"]["omega0"]);
    const Mat3 I = vec3(c["inputs"]["I"]).asDiagonal();
    model::BodyState bodies = one_body(I, quat(c["inputs"]["q0"]), w0);
    long steps = 0;
    for (std::size_t k = 0; k < expected["t"].size(); ++k) {
      for (; steps < std::lround(expected["t"][k].get<double>() / 0.01); ++steps)
        dynamics::advance_poses(bodies, {}, 0.01);
      EXPECT_LT(angle_between(bodies.q_WB[0], quat(expected["q"][k])), 1e-11);
      const Vec3 w_body = bodies.q_WB[0].conjugate() * bodies.w_W[0];
      EXPECT_LT((w_body - vec3(expected["omega_body"][k])).norm(), 1e-10);
    }
    EXPECT_EQ(bodies.L_W[0], vec3(expected["L_world"]));
    EXPECT_NEAR(0.5 * bodies.w_W[0].dot(bodies.L_W[0]), expected["T"].get<double>(), 1e-10);
    return;
  }
  FAIL() << "golden case missing";
}

TEST(TorqueFree, AsymmetricTopConvergesWithSecondOrder) {
  const Mat3 I = Vec3(1.0, 2.0, 3.0).asDiagonal();
  const auto end = [&](int steps) {
    model::BodyState bodies = one_body(I, Quat::Identity(), Vec3(1.0, 0.5, 1.0));
    for (int k = 0; k < steps; ++k) dynamics::advance_poses(bodies, {}, 5.0 / steps);
    return bodies;
  };
  const Quat reference = end(100000).q_WB[0];
  const double coarse = angle_between(end(250).q_WB[0], reference);
  const double fine = angle_between(end(500).q_WB[0], reference);
  EXPECT_LT(fine, 1e-4);
  EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.1);
  const model::BodyState bodies = end(500);
  const double energy = 0.5 * bodies.w_W[0].dot(bodies.L_W[0]);
  EXPECT_NEAR(energy, 0.5 * (1.0 + 2.0 * 0.25 + 3.0), 2e-5);
}

TEST(TorqueFree, PrincipalAxesNeedNotBeTheBodyAxes) {
  const Quat turned = Quat(0.3, -0.5, 0.7, 0.2).normalized();
  const Mat3 R = turned.toRotationMatrix();
  const Mat3 I = Vec3(1.0, 2.0, 3.0).asDiagonal();
  model::BodyState plain = one_body(I, turned, Vec3(1.0, 0.5, 1.0));
  model::BodyState rotated = one_body(R * I * R.transpose(), Quat::Identity(), Vec3(1.0, 0.5, 1.0));
  for (int k = 0; k < 500; ++k) {
    dynamics::advance_poses(plain, {}, 0.01);
    dynamics::advance_poses(rotated, {}, 0.01);
  }
  EXPECT_LT((plain.w_W[0] - rotated.w_W[0]).norm(), 1e-11);
  EXPECT_LT(angle_between(plain.q_WB[0], rotated.q_WB[0] * turned), 1e-11);
}

TEST(TorqueFree, ExplicitEulerKeepsTheAngularVelocity) {
  const Mat3 I = Vec3(1.0, 2.0, 3.0).asDiagonal();
  model::BodyState bodies = one_body(I, Quat::Identity(), Vec3(1.0, 0.5, 1.0));
  for (int k = 0; k < 100; ++k) dynamics::advance_poses_explicit(bodies, 0.01);
  EXPECT_LT((bodies.w_W[0] - Vec3(1.0, 0.5, 1.0)).norm(), 1e-12);
}

// Bodies are rotated several at a time, some of them slow, some fast, between others that do not
// move freely: each to the bits that it has alone, with the inertia that a resumed run computes.
TEST(TorqueFree, BodiesRotateAsIfAlone) {
  constexpr model::BodyIndex kBodies = 21;
  Random random(7);
  model::BodyState bodies;
  for (model::BodyIndex i = 0; i < kBodies; ++i) {
    model::append_body(bodies);
    bodies.v_W[i] = random.unit_vector();
    bodies.q_WB[i] = random.rotation();
    if (i % 7 == 3) {
      bodies.w_W[i] = random.unit_vector();
      if (i > 5) bodies.kind[i] = model::BodyKind::kinematic;
      continue;
    }
    bodies.kind[i] = model::BodyKind::dynamic;
    const Mat3 axes = random.rotation().toRotationMatrix();
    const Vec3 moments(random.uniform(1.0, 2.0), random.uniform(1.0, 2.0),
                       random.uniform(1.0, 2.0));
    model::set_mass(bodies, i, 1.0, axes * moments.asDiagonal() * axes.transpose());
    bodies.L_W[i] = (i % 5 == 0 ? 1000.0 : 1.0) * random.unit_vector();
    model::refresh_derived(bodies, i);
  }
  const auto copy_of = [](const model::BodyState& from, model::BodyIndex i) {
    model::BodyState one = from;
    for (model::BodyIndex k = kBodies; k-- > 0;)
      if (k != i) model::erase_body(one, k);
    return one;
  };
  model::BodyState together = bodies;
  for (int step = 0; step < 3; ++step) dynamics::advance_poses(together, {}, 0.01);
  for (model::BodyIndex i = 0; i < kBodies; ++i) {
    model::BodyState alone = copy_of(bodies, i);
    for (int step = 0; step < 3; ++step) dynamics::advance_poses(alone, {}, 0.01);
    EXPECT_EQ(together.x_W[i], alone.x_W[0]) << i;
    EXPECT_EQ(together.q_WB[i].coeffs(), alone.q_WB[0].coeffs()) << i;
    EXPECT_EQ(together.w_W[i], alone.w_W[0]) << i;
    model::refresh_derived(alone, 0);
    EXPECT_EQ(together.inverse_I_W[i], alone.inverse_I_W[0]) << i;
    EXPECT_LT((together.w_W[i] - alone.w_W[0]).norm(), 1e-14 * (1.0 + alone.w_W[0].norm())) << i;
  }
}

}  // namespace
}  // namespace gotai
