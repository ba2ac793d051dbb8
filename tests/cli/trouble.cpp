// Trouble outside of the scene: a lost terminal, a folder that cannot be written, a run that
// breaks.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "program.h"
#include "scenes.h"

namespace gotai::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(LostTerminal, EndsTheRunAfterItsStepAndSaysHowToGoOn) {
  const TemporaryFolder folder;
  const std::string scene = write_text(folder, "scene.toml", kManyHexapods);
  for (const int signal : {SIGHUP, SIGTERM}) {
    const std::string path = folder.file("run" + std::to_string(signal) + ".h5");
    Program program({"run", scene, "-o", path, "--set", "world.duration=600"});
    while (program.is_running() && !std::filesystem::exists(path)) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    program.send_signal(signal);
    const Outcome stopped = program.finish();
    EXPECT_EQ(stopped.exit_code, 130) << stopped.err;
    EXPECT_THAT(stopped.err, HasSubstr("gotai run --resume " + path));
    const auto info = run_gotai({"info", path, "--json"}).json();
    EXPECT_EQ(info.at("complete"), true) << "the recording was closed";
    const double end = info.at("certificate").at("simulated_s").get<double>();
    const Outcome longer = run_gotai({"run", "--resume", path, "--json", "--set",
                                      "world.duration=" + std::to_string(end + 0.05)});
    EXPECT_EQ(longer.exit_code, 0) << longer.err;
  }
}

TEST(Runaway, StopsTheRunWithItsStateSaved) {
  const TemporaryFolder folder;
  const std::string scene = write_text(folder, "scene.toml", kTwoCubes);
  const std::string path = folder.file("run.h5");
  const Outcome outcome = run_gotai(
      {"run", scene, "-o", path, "--set", "world.gravity=[0, 0, 1e8]", "--set", "record.fps=200"});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("step 4 (t = 0.02"), HasSubstr("body \"cube 1\""),
                                 HasSubstr("energy ran away"), HasSubstr(path)));
  const auto info = run_gotai({"info", path, "--json"}).json();
  EXPECT_EQ(info.at("frames"), 4) << "the start and three steps";
  EXPECT_EQ(info.at("complete"), false);
  const Outcome again = run_gotai({"run", "--resume", path});
  EXPECT_EQ(again.exit_code, 3) << "goes on from the saved state to the same end";
  EXPECT_THAT(again.err, HasSubstr("step 4 (t = 0.02"));
}

// A user who is not allowed everything, and a folder that it can only read.
class ReadOnly : public testing::Test {
 protected:
  void SetUp() override {
    scene_ = write_text(folder_, "scene.toml", kTwoCubes);
    ASSERT_EQ(run_gotai({"run", scene_, "-o", folder_.file("run.h5")}).exit_code, 0);
    using std::filesystem::perms;
    std::filesystem::permissions(folder_.file("."), perms::owner_read | perms::owner_exec |
                                                        perms::others_read | perms::others_exec);
    for (const char* name : {"scene.toml", "run.h5"}) {
      std::filesystem::permissions(folder_.file(name), perms::owner_read | perms::others_read);
    }
    std::filesystem::permissions(output_.file("."), perms::all);
    if (run("--version").exit_code != 0) GTEST_SKIP() << "nobody cannot start the program here";
  }
  void TearDown() override {
    std::filesystem::permissions(folder_.file("."), std::filesystem::perms::owner_all);
  }

  // Runs the program with these words, as nobody when root runs the tests.
  Outcome run(const std::string& words, const std::string& environment = "GOTAI_CACHE=") const {
    const std::string user =
        geteuid() == 0 ? "setpriv --reuid=65534 --regid=65534 --clear-groups " : "";
    const std::string command = user + "env " + environment + " " + GOTAI_PROGRAM + " " + words +
                                " >" + output_.file("out") + " 2>" + output_.file("err");
    Outcome outcome;
    const int status = std::system(command.c_str());
    outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
    outcome.out = read(output_.file("out"));
    outcome.err = read(output_.file("err"));
    return outcome;
  }

  static std::string read(const std::string& path) {
    std::ifstream in(path);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
  }

  TemporaryFolder folder_;
  TemporaryFolder output_;
  std::string scene_;
};

TEST_F(ReadOnly, OutputsAreRefusedByNameBeforeTheWork) {
  const std::string recording = folder_.file("run.h5");
  const std::pair<std::string, std::string> lines[] = {
      {"run " + scene_ + " -o ", folder_.file("new.h5")},
      {"run --resume ", recording},
      {"shape --generate cube -o ", folder_.file("new.gotai-shape")},
      {"export " + recording + " -o ", folder_.file("new.glb")},
      {"export " + recording + " -o ", folder_.file("new.csv")},
  };
  for (const auto& [words, path] : lines) {
    const Outcome outcome = run(words + path);
    EXPECT_EQ(outcome.exit_code, 1) << words;
    EXPECT_EQ(outcome.out, "") << words;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr(path), HasSubstr("Permission denied"))) << words;
  }
}

TEST_F(ReadOnly, WhatIsThereCanBeRead) {
  const std::string recording = folder_.file("run.h5");
  const Outcome info = run("info --json " + recording);
  ASSERT_EQ(info.exit_code, 0) << info.err;
  EXPECT_EQ(info.json().at("frames"), 31);
  EXPECT_EQ(run("export " + recording + " -o " + output_.file("run.csv")).exit_code, 0);
}

TEST_F(ReadOnly, ACacheThatCannotBeWrittenIsOnlyAWarning) {
  const Outcome outcome = run("run --json " + scene_, "GOTAI_CACHE=" + folder_.file("cache"));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("warning"), HasSubstr(folder_.file("cache"))));
}

}  // namespace
}  // namespace gotai::test
