// Plain data of the model: columns, materials, settings, contacts.
#include <gmock/gmock.h>

#include "gotai/core/error.h"
#include "gotai/model/body_state.h"
#include "gotai/model/contact_set.h"
#include "gotai/model/material.h"
#include "gotai/model/settings.h"

namespace gotai::model {
namespace {

using ::testing::HasSubstr;

template <typename Function>
std::string message_of(const Function& f) {
  try {
    f();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(BodyState, ErasingMovesLaterColumnsUp) {
  BodyState bodies;
  for (int k = 0; k < 3; ++k) {
    const BodyIndex i = append_body(bodies);
    bodies.kind[i] = BodyKind::dynamic;
    set_mass(bodies, i, k + 1.0, Mat3::Identity());
    bodies.x_W[i] = Vec3(k, 0, 0);
  }
  erase_body(bodies, 1);
  ASSERT_EQ(bodies.size(), 2U);
  EXPECT_EQ(bodies.x_W[1].x(), 2.0);
  EXPECT_EQ(bodies.inverse_mass[1], 1.0 / 3.0);
  EXPECT_NO_THROW(validate(bodies));
}

TEST(BodyState, InverseInertiaFollowsTheOrientation) {
  BodyState bodies;
  const BodyIndex i = append_body(bodies);
  Mat3 I;
  I << 2.0, 0.1, 0.2, 0.1, 3.0, -0.3, 0.2, -0.3, 4.0;
  bodies.q_WB[i] = Quat(0.5, 0.1, -0.7, 0.3).normalized();
  set_mass(bodies, i, 1.0, I);
  const Mat3 R = bodies.q_WB[i].toRotationMatrix();
  EXPECT_LT((bodies.inverse_I_W[i] - R * I.inverse() * R.transpose()).norm(), 1e-14);
  const Vec3 w(0.3, -2.0, 1.0);
  bodies.L_W[i] = angular_momentum(bodies, i, w);
  refresh_derived(bodies, i);
  EXPECT_LT((bodies.w_W[i] - w).norm(), 1e-14);
}

TEST(BodyState, RefusesImpossibleMass) {
  BodyState bodies;
  const BodyIndex i = append_body(bodies);
  EXPECT_THAT(message_of([&] { set_mass(bodies, i, -1.0, Mat3::Identity()); }),
              HasSubstr("must be positive"));
  EXPECT_THAT(message_of([&] { set_mass(bodies, i, 1.0, Mat3::Zero()); }),
              HasSubstr("positive definite"));
}

TEST(BodyState, ValidateNamesTheBody) {
  BodyState bodies;
  append_body(bodies);
  append_body(bodies);
  bodies.v_W[1].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(message_of([&] { validate(bodies); }), HasSubstr("body 1: velocity"));
}

TEST(Materials, CombineByRuleUnlessOverridden) {
  MaterialTable table;
  table.materials = {{"a", 0.2, 0.4, 1.0}, {"b", 0.6, 0.9, 1.0}};
  EXPECT_DOUBLE_EQ(table.combine(0, 1).restitution, 0.6);
  EXPECT_DOUBLE_EQ(table.combine(1, 0).friction, 0.6);
  EXPECT_EQ(table.combine(0, 0).friction, 0.4);
  table.overrides[{0, 1}] = {0.1, 0.05};
  EXPECT_EQ(table.combine(1, 0).friction, 0.05);
  table.materials[1].friction = -1.0;
  EXPECT_THAT(message_of([&] { validate(table); }), HasSubstr("material 'b'.friction = -1"));
}

TEST(Settings, NamesRoundTripAndErrorsListThem) {
  for (const ImpulseMethodName name :
       {ImpulseMethodName::penalty, ImpulseMethodName::impulse, ImpulseMethodName::impulse_averaged,
        ImpulseMethodName::constraint, ImpulseMethodName::sem, ImpulseMethodName::vector_field})
    EXPECT_EQ(parse_impulse_method(to_string(name)), name);
  EXPECT_THAT(message_of([] { parse_impulse_method("magic"); }),
              HasSubstr("penalty, impulse, impulse-averaged, constraint, sem, vector-field"));
}

TEST(Settings, ValidateNamesTheSetting) {
  Settings settings;
  EXPECT_NO_THROW(validate(settings));
  settings.collision.level = 0;
  EXPECT_THAT(message_of([&] { validate(settings); }), HasSubstr("collision.level = 0"));
  settings.collision.level = 6;
  settings.impulse.penetration = 1e-9;
  EXPECT_THAT(message_of([&] { validate(settings); }), HasSubstr("impulse.penetration = 1e-09"));
  settings.impulse.penetration = 1e-3;
  settings.impulse.rolling_resistance = 1.5;
  EXPECT_THAT(message_of([&] { validate(settings); }),
              HasSubstr("impulse.rolling_resistance = 1.5: must be in [0, 1]"));
}

TEST(Settings, FewContactsOfTheSurfacesUnlessAnotherMethodReadsThem) {
  Settings settings;
  EXPECT_EQ(settings.collision.model, CollisionModel::surface);
  EXPECT_EQ(contact_treatment(settings), ContactTreatment::reduced);
  settings.impulse.method = ImpulseMethodName::penalty;
  EXPECT_EQ(contact_treatment(settings), ContactTreatment::all);
  settings.impulse.method = ImpulseMethodName::constraint;
  settings.collision.model = CollisionModel::spheres;
  EXPECT_EQ(contact_treatment(settings), ContactTreatment::all);
  settings.impulse.contacts = ContactTreatment::apparent;
  EXPECT_EQ(contact_treatment(settings), ContactTreatment::apparent);
}

TEST(ContactSet, GapsFollowTheAnchors) {
  BodyState bodies;
  append_body(bodies);
  append_body(bodies);
  bodies.x_W[0] = Vec3(0, 0, 1);
  ContactSet contacts;
  contacts.pairs.push_back({0, 1, 0, 0});
  contacts.push(Vec3::Zero(), Vec3::UnitZ(), 0.1, Vec3(0, 0, -0.9), Vec3::Zero(), 1.0, 7);
  EXPECT_NO_THROW(validate(contacts, bodies.size()));
  std::vector<double> gap;
  refresh_gaps(bodies, contacts, gap);
  EXPECT_NEAR(gap[0], 0.1, 1e-15);
  bodies.x_W[0].z() = 0.85;
  refresh_gaps(bodies, contacts, gap);
  EXPECT_NEAR(gap[0], -0.05, 1e-15);
}

TEST(ContactSet, ValidateFindsDisorder) {
  ContactSet contacts;
  contacts.pairs.push_back({0, 1, 0, 0});
  contacts.push(Vec3::Zero(), Vec3::UnitZ(), 0.0, Vec3::Zero(), Vec3::Zero(), 1.0, 7);
  contacts.push(Vec3::Zero(), Vec3::UnitZ(), 0.0, Vec3::Zero(), Vec3::Zero(), 1.0, 7);
  EXPECT_THAT(message_of([&] { validate(contacts, 2); }), HasSubstr("features are not sorted"));
  contacts.feature[1] = 8;
  contacts.normal_W[1] = Vec3(0, 0, 2);
  EXPECT_THAT(message_of([&] { validate(contacts, 2); }), HasSubstr("normal"));
}

}  // namespace
}  // namespace gotai::model
