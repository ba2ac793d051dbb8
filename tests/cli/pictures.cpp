// `gotai view` and `gotai render`, end to end.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <string>

#include "program.h"
#include "scenes.h"

namespace gotai::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Pictures : public testing::Test {
 protected:
  void SetUp() override {
    const std::string scene = write_text(folder, "scene.toml", kTwoCubes);
    recording = folder.file("run.h5");
    const Outcome outcome = run_gotai({"run", scene, "-o", recording});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  std::string at(const std::string& name) const { return folder.file(name); }
  /// `gotai COMMAND RECORDING ...`
  Outcome gotai(const std::string& command, std::vector<std::string> words) const {
    words.insert(words.begin(), {command, recording});
    return run_gotai(words);
  }

  TemporaryFolder folder;
  std::string recording;
};

/// Width and height of a PNG file.
std::array<unsigned, 2> png_size(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::array<unsigned char, 24> head{};
  in.read(reinterpret_cast<char*>(head.data()), head.size());
  EXPECT_EQ(std::string(head.begin() + 1, head.begin() + 4), "PNG") << path;
  const auto number = [&](std::size_t i) {
    return (unsigned{head[i]} << 24U) | (unsigned{head[i + 1]} << 16U) |
           (unsigned{head[i + 2]} << 8U) | unsigned{head[i + 3]};
  };
  return {number(16), number(20)};
}

TEST_F(Pictures, ViewWritesOnePageOrSaysWhatIsMissing) {
  const Outcome outcome = gotai("view", {"-o", at("run.html")});
  if (outcome.exit_code != 0) {
    EXPECT_THAT(outcome.err, HasSubstr("built without the viewer"));
    EXPECT_THAT(outcome.err, HasSubstr("nodejs"));
    GTEST_SKIP() << "built without the viewer";
  }
  EXPECT_THAT(outcome.out, HasSubstr("run.html"));
  EXPECT_GT(fs::file_size(at("run.html")), 500'000U);
  const Outcome again = gotai("view", {"-o", at("run.html")});
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_THAT(again.err, HasSubstr("--force"));
  EXPECT_EQ(gotai("view", {"-o", at("run.html"), "--force"}).exit_code, 0);
}

TEST_F(Pictures, RenderDrawsMomentsAndStrips) {
  const std::vector<std::string> small{"--size", "64x48", "--samples", "1"};
  const auto with = [&](std::vector<std::string> words) {
    words.insert(words.end(), small.begin(), small.end());
    return words;
  };
  ASSERT_EQ(gotai("render", with({"-o", at("end.png")})).exit_code, 0);
  EXPECT_EQ(png_size(at("end.png")), (std::array<unsigned, 2>{64, 48}));
  ASSERT_EQ(gotai("render", with({"-o", at("strip.png"), "--strip", "3"})).exit_code, 0);
  EXPECT_EQ(png_size(at("strip.png")), (std::array<unsigned, 2>{3 * 64 + 2, 48}));
  ASSERT_EQ(gotai("render", with({"-o", at("frames/"), "--fps", "10"})).exit_code, 0);
  EXPECT_TRUE(fs::exists(at("frames/frame_00004.png")));
  EXPECT_FALSE(fs::exists(at("frames/frame_00006.png")));
}

TEST_F(Pictures, RenderExplainsMistakes) {
  const auto error = [&](const std::vector<std::string>& words) {
    const Outcome outcome = gotai("render", words);
    EXPECT_EQ(outcome.exit_code, 1) << testing::PrintToString(words);
    return outcome.err;
  };
  EXPECT_THAT(error({"-o", at("run.gif")}), HasSubstr(".png, .mp4"));
  EXPECT_THAT(error({"-o", at("a.png"), "--strip", "2", "--begin", "9"}),
              HasSubstr("after the end"));
  EXPECT_THAT(error({"-o", at("a.png"), "--size", "64"}), HasSubstr("WIDTHxHEIGHT"));
  EXPECT_THAT(error({"-o", at("a.png"), "--size", "9x9"}), HasSubstr("16x16"));
  EXPECT_THAT(error({"-o", at("a.png"), "--samples", "99"}), HasSubstr("between 1 and 8"));
  EXPECT_THAT(error({"-o", at("a.png"), "--colour", "red"}), HasSubstr("material, speed"));
  EXPECT_THAT(error({"-o", at("a.png"), "--from", "0", "0", "0"}), HasSubstr("direction"));
  EXPECT_FALSE(fs::exists(at("a.png")));
  const Outcome missing = run_gotai({"render", at("no.h5"), "-o", at("a.png")});
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_THAT(missing.err, HasSubstr("no.h5"));
}

}  // namespace
}  // namespace gotai::test
