// Pose files.
#include "gotai/scene/pose_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "gotai/core/error.h"

namespace gotai::scene {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::string pose_message(const std::string& text) {
  try {
    parse_poses(text, "poses.csv");
  } catch (const FileError& error) {
    return error.what();
  }
  return "no error";
}

TEST(PoseFile, ReadsCommentsHeaderAndPoses) {
  const auto poses = parse_poses(
      "# a comment\npx,py,pz,qw,qx,qy,qz\r\n1,-2.5, 3e-1,1,0,0,0\n\n4,5,6,0,+1,0,0", "poses.csv");
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_EQ(poses[0].p, Vec3(1, -2.5, 0.3));
  EXPECT_EQ(poses[1].q.x(), 1.0);
}

TEST(PoseFile, MistakesNameLineAndColumn) {
  const std::string header = "px,py,pz,qw,qx,qy,qz\n";
  EXPECT_THAT(pose_message("1,2,3,1,0,0,0\n"),
              StartsWith("poses.csv:1:1: the first line must name"));
  EXPECT_THAT(pose_message(header + "1,2,3,1,0,0\n"), HasSubstr("needs the 7 numbers"));
  EXPECT_THAT(pose_message(header + "1,2,3,1,0,0,0,0\n"),
              StartsWith("poses.csv:2:13: a pose needs"));
  EXPECT_THAT(pose_message(header + "1,2,x,1,0,0,0\n"),
              StartsWith("poses.csv:2:5: \"x\" is not a finite number"));
  EXPECT_THAT(pose_message(header + "1,2,inf,1,0,0,0\n"), HasSubstr("not a finite number"));
  EXPECT_THAT(pose_message(header + "1,2,3,0,0,0,0\n"), HasSubstr("must have length 1"));
  EXPECT_THAT(pose_message(header), HasSubstr("holds no poses"));
  EXPECT_THROW(load_poses("no/such/file.csv"), FileError);
}

TEST(PoseFile, ReadsTheWorkloadsOfTheBenchmark) {
  const std::string path = std::string(GOTAI_SHARED_DIR) + "/bench/hexapod_100.csv";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "needs " << path;
  EXPECT_EQ(load_poses(path).size(), 100u);
}

}  // namespace
}  // namespace gotai::scene
