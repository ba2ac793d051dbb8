// Interrupted runs lose nothing, and go on to the same state.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <thread>

#include "program.h"
#include "scenes.h"

namespace gotai::test {
namespace {

using testing::HasSubstr;

std::string state_hash(const Outcome& outcome) {
  return outcome.exit_code == 0 ? outcome.json().at("state_hash").get<std::string>() : outcome.err;
}

TEST(Resume, KilledRunsEndInTheStateOfAnUninterruptedOne) {
  const TemporaryFolder folder;
  const std::string scene = write_text(folder, "scene.toml", kManyHexapods);
  const std::string expected = state_hash(run_gotai({"run", scene, "--json"}));
  int resumed = 0;
  for (int run = 0; run < 4; ++run) {
    const std::string path = folder.file("run" + std::to_string(run) + ".h5");
    Program program({"run", scene, "-o", path, "--set", "record.checkpoint=0.01"});
    while (program.is_running() &&
           (!std::filesystem::exists(path) || std::filesystem::file_size(path) == 0)) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20 + 70 * run));
    program.send_signal(SIGKILL);
    program.finish();
    const Outcome info = run_gotai({"info", path, "--json"});
    ASSERT_EQ(info.exit_code, 0) << info.err;
    const Outcome outcome = run_gotai({"run", "--resume", path, "--json"});
    EXPECT_EQ(state_hash(outcome), expected);
    if (outcome.json().at("simulated_s").get<double>() < 2.0) ++resumed;
  }
  EXPECT_GT(resumed, 0) << "at least one run was killed after a checkpoint";
}

TEST(Resume, CtrlCSaysHowToGoOn) {
  const TemporaryFolder folder;
  const std::string scene = write_text(folder, "scene.toml", kManyHexapods);
  const std::string path = folder.file("run.h5");
  Program program({"run", scene, "-o", path, "--set", "world.duration=600"});
  while (!std::filesystem::exists(path)) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  program.send_signal(SIGINT);
  const Outcome stopped = program.finish();
  EXPECT_EQ(stopped.exit_code, 130);
  EXPECT_THAT(stopped.err, HasSubstr("gotai run --resume " + path));
}

TEST(Resume, MakesARunLonger) {
  const TemporaryFolder folder;
  const std::string scene = write_text(folder, "scene.toml", kTwoCubes);
  const std::string path = folder.file("run.h5");
  ASSERT_EQ(run_gotai({"run", scene, "-o", path}).exit_code, 0);
  const Outcome longer =
      run_gotai({"run", "--resume", path, "--json", "--set", "world.duration=0.8"});
  EXPECT_NEAR(longer.json().at("simulated_s").get<double>(), 0.3, 1e-9);
  const Outcome whole = run_gotai({"run", scene, "--json", "--set", "world.duration=0.8"});
  EXPECT_EQ(state_hash(longer), state_hash(whole));
}

TEST(Resume, MistakesSayWhatToDo) {
  const TemporaryFolder folder;
  const std::string scene = write_text(folder, "scene.toml", kTwoCubes);
  const std::string path = folder.file("run.h5");
  ASSERT_EQ(run_gotai({"run", scene, "-o", path}).exit_code, 0);
  const Outcome changed = run_gotai({"run", "--resume", path, "--set", "time.step=0.1"});
  EXPECT_EQ(changed.exit_code, 1);
  EXPECT_THAT(changed.err, HasSubstr("a resumed run keeps its scene"));
  EXPECT_EQ(run_gotai({"run"}).exit_code, 2);
  EXPECT_EQ(run_gotai({"run", scene, "--resume", path}).exit_code, 2);
  EXPECT_EQ(run_gotai({"run", "--resume", folder.file("none.h5")}).exit_code, 1);
}

}  // namespace
}  // namespace gotai::test
