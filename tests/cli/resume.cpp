// Interrupted runs lose nothing, and go on to the same state.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
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
  for (const std::string model : {"spheres", "surface"}) {
    const std::string setting = "collision.model=" + model;
    const std::string path = folder.file(model + ".h5");
    ASSERT_EQ(run_gotai({"run", scene, "-o", path, "--set", setting}).exit_code, 0);
    const Outcome longer =
        run_gotai({"run", "--resume", path, "--json", "--set", "world.duration=0.8"});
    EXPECT_NEAR(longer.json().at("simulated_s").get<double>(), 0.3, 1e-9);
    const Outcome whole =
        run_gotai({"run", scene, "--json", "--set", setting, "--set", "world.duration=0.8"});
    EXPECT_EQ(state_hash(longer), state_hash(whole)) << model;
  }
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

TEST(FullDisk, TheFramesBeforeItAreReadable) {
  const TemporaryFolder folder;
  const std::string scene = write_text(folder, "scene.toml", kManyHexapods);
  const std::string out = folder.file("out.txt");
  const std::string disk = folder.file("disk");
  std::filesystem::create_directory(disk);
  // A disk of 8 MB of its own, in a name space of its own; what is seen there goes to `out`.
  const std::string script =
      "mount -t tmpfs -o size=8m none " + disk + " || exit 77; " + GOTAI_PROGRAM + " run " + scene +
      " -o " + disk + "/run.h5 --set world.duration=1000 --set record.fps=100000 " +
      "--set time.step=0.001 --set pour.0.count=4 2>&1; " + "echo exit code $?; " + GOTAI_PROGRAM +
      " info " + disk + "/run.h5 --json";
  const std::string command = "unshare -rm sh -c '" + script + "' >" + out + " 2>/dev/null";
  if (std::system(command.c_str()) != 0) GTEST_SKIP() << "needs unshare and mount of tmpfs";
  std::ifstream in(out);
  const std::string said((std::istreambuf_iterator<char>(in)), {});
  EXPECT_THAT(said, HasSubstr("No space left on device"));
  EXPECT_THAT(said, HasSubstr("exit code 1"));
  const std::size_t object = said.find('{');
  ASSERT_NE(object, std::string::npos) << said;
  const auto info = nlohmann::json::parse(said.substr(object));
  EXPECT_GT(info.at("frames").get<int>(), 10) << said;
}

}  // namespace
}  // namespace gotai::test
