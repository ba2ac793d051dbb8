// A run that has gone wrong stops and says where.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gotai/core/error.h"
#include "support/falling_cubes.h"

namespace gotai {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string failure_after(const Vec3& velocity) {
  World world = test::falling_cubes(2);
  world.step();
  world.set_velocity(world.id(3), velocity, Vec3::Zero());
  try {
    world.step();
  } catch (const SimulationError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Runaway, NamesStepBodyAndCause) {
  EXPECT_THAT(failure_after(Vec3(0, 0, 1e8)),
              AllOf(HasSubstr("step 2"), HasSubstr("\"cube 2\""), HasSubstr("energy ran away")));
  EXPECT_EQ(failure_after(Vec3(0, 0, 1e3)), "no error") << "fast is not wrong";
}

}  // namespace
}  // namespace gotai
