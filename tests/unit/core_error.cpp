#include <gtest/gtest.h>

#include "gotai/core/error.h"

namespace gotai {
namespace {

TEST(Error, InvalidArgumentNamesArgumentValueAndReason) {
  const InvalidArgument error("material.friction", "-0.1", "must be >= 0");
  EXPECT_STREQ(error.what(), "material.friction = -0.1: must be >= 0");
}

TEST(Error, FileErrorStartsWithThePlace) {
  EXPECT_STREQ(FileError("a.obj", "is empty").what(), "a.obj: is empty");
  EXPECT_STREQ(FileError("a.obj", 3, 0, "bad number").what(), "a.obj:3: bad number");
  EXPECT_STREQ(FileError("a.toml", 3, 14, "unknown key").what(), "a.toml:3:14: unknown key");
  // A column without a line says nothing.
  EXPECT_STREQ(FileError("a.toml", 0, 14, "unknown key").what(), "a.toml: unknown key");
}

TEST(Error, EveryExceptionOfTheLibraryIsAnError) {
  EXPECT_THROW(throw InvalidArgument("a", "b", "c"), Error);
  EXPECT_THROW(throw FileError("a", "b"), Error);
  EXPECT_THROW(throw SimulationError("a"), Error);
}

}  // namespace
}  // namespace gotai
