#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "program.h"
#include "scenes.h"

namespace gotai::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

TEST(Run, JsonHasEveryDocumentedField) {
  const TemporaryFolder folder;
  const std::string scene = write_text(folder, "scene.toml", kTwoCubes);
  const Outcome outcome = run_gotai(
      {"run", scene, "-o", folder.file("run.h5"), "--json", "--set", "collision.model=spheres"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const json result = outcome.json();
  EXPECT_EQ(result.at("bodies"), 2);
  EXPECT_EQ(result.at("steps"), 100);
  EXPECT_NEAR(result.at("simulated_s"), 0.5, 1e-12);
  EXPECT_GT(result.at("wall_s"), 0.0);
  for (const char* key : {"mean", "p95", "max", "last_second_mean"}) {
    EXPECT_GT(result.at("step_ms").at(key), 0.0) << key;
  }
  for (const char* key : {"collision", "impulse", "integration", "other"}) {
    EXPECT_GE(result.at("phase_ms").at(key), 0.0) << key;
  }
  EXPECT_GE(result.at("contacts").at("max"), 16);  // a flat face at level 3
  EXPECT_GT(result.at("contacts").at("mean"), 0.0);
  EXPECT_GE(result.at("overlap").at("max"), result.at("overlap").at("mean"));
  for (const char* key : {"touching", "mean", "p99", "max", "max_m", "gap3"}) {
    EXPECT_EQ(result.at("true_overlap").at(key), 0.0) << key << ": sphere contacts hover";
  }
  EXPECT_GT(result.at("step_margin"), 0.0);
  EXPECT_LT(result.at("energy").at("final"), result.at("energy").at("initial"));
  EXPECT_LT(result.at("energy").at("max_gain"),
            1e-6 * result.at("energy").at("initial").get<double>());
  EXPECT_LT(result.at("momentum_error"), 1e-10);
  EXPECT_LT(result.at("residual_max"), 1e-6);
  EXPECT_EQ(result.at("escaped"), 0);
  EXPECT_THAT(result.at("state_hash"), testing::MatchesRegex("[0-9a-f]{32}"));
}

// What scenes collide with unless they say otherwise: bodies touch where their meshes do, and the
// lanes of the sub-stepped solver keep momentum to single precision.
TEST(Run, JsonCertifiesARunOnTrueSurfaces) {
  const TemporaryFolder folder;
  const std::string scene = write_text(folder, "scene.toml", kTwoCubes);
  const json result = run_gotai({"run", scene, "--json", "--set", "world.duration=3"}).json();
  const json& penetration = result.at("true_overlap");
  EXPECT_EQ(penetration.at("touching"), 2);
  EXPECT_LT(penetration.at("max"), 5e-4);
  EXPECT_LT(result.at("momentum_error"), 1e-6);
  EXPECT_LT(result.at("energy").at("max_gain"),
            1e-6 * result.at("energy").at("initial").get<double>());
  EXPECT_EQ(result.at("escaped"), 0);
}

TEST(Run, TheTableForPeopleSaysWhereTheRecordingIs) {
  const TemporaryFolder folder;
  const std::string scene = write_text(folder, "scene.toml", kTwoCubes);
  const std::string recording = folder.file("run.h5");
  const Outcome outcome = run_gotai({"run", scene, "-o", recording});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("state hash"));
  EXPECT_THAT(outcome.out, HasSubstr(recording));
  EXPECT_EQ(outcome.err, "") << "no progress when piped";
}

TEST(Run, TheSameStateForAnyNumberOfThreadsAndTwiceInARow) {
  const TemporaryFolder folder;
  const std::string scene = write_text(folder, "scene.toml", kManyHexapods);
  const auto state_hash = [&](const char* threads) {
    return run_gotai({"run", scene, "--json", "--threads", threads, "--set", "world.duration=1"})
        .json()
        .at("state_hash")
        .get<std::string>();
  };
  const std::string once = state_hash("1");
  EXPECT_EQ(state_hash("1"), once);
  EXPECT_EQ(state_hash("2"), once);
  EXPECT_EQ(state_hash("4"), once);
}

TEST(Run, TheSameStateWithEveryInstructionSet) {
  const TemporaryFolder folder;
  const std::string scene = write_text(folder, "scene.toml", kManyHexapods);
  const auto run = [&] { return run_gotai({"run", scene, "--json"}).json(); };
  const json fastest = run();
  EXPECT_GT(fastest.at("contacts").at("max"), 50);
  for (const char* instructions : {"portable", "avx2"}) {
    ::setenv("GOTAI_INSTRUCTIONS", instructions, 1);
    EXPECT_EQ(run().at("state_hash"), fastest.at("state_hash")) << instructions;
    ::unsetenv("GOTAI_INSTRUCTIONS");
  }
}

TEST(Run, RecordingDoesNotChangeTheSimulation) {
  const TemporaryFolder folder;
  const std::string scene = write_text(folder, "scene.toml", kTwoCubes);
  const Outcome bare = run_gotai({"run", scene, "--json"});
  const Outcome recorded = run_gotai({"run", scene, "--json", "-o", folder.file("run.h5")});
  EXPECT_EQ(bare.json().at("state_hash"), recorded.json().at("state_hash"));
}

TEST(Run, SetOverridesTheScene) {
  const TemporaryFolder folder;
  const std::string scene = write_text(folder, "scene.toml", kTwoCubes);
  const json result =
      run_gotai({"run", scene, "--json", "--set", "time.step=0.01", "--set", "world.duration=0.2"})
          .json();
  EXPECT_EQ(result.at("steps"), 20);
}

TEST(Run, NeverOverwritesWithoutForce) {
  const TemporaryFolder folder;
  const std::string scene = write_text(folder, "scene.toml", kTwoCubes);
  const std::string taken = write_text(folder, "taken.h5", "precious");
  const Outcome refused = run_gotai({"run", scene, "-o", taken});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, HasSubstr(taken));
  EXPECT_THAT(refused.err, HasSubstr("--force"));
  EXPECT_EQ(std::filesystem::file_size(taken), 8U);
  EXPECT_EQ(run_gotai({"run", scene, "-o", taken, "--force"}).exit_code, 0);
  EXPECT_EQ(run_gotai({"info", taken, "--json"}).json().at("kind"), "recording");
}

TEST(Run, AnOutputThatCannotBeWrittenIsSaidBeforeTheRun) {
  const TemporaryFolder folder;
  const std::string scene = write_text(folder, "scene.toml", kTwoCubes);
  const std::string nowhere = folder.file("missing/run.h5");
  const Outcome outcome = run_gotai({"run", scene, "-o", nowhere});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr(nowhere));
}

// Waits until a recording has been flushed with frames in it: the file grows for the second time.
void wait_for_frames(const std::filesystem::path& recording) {
  std::uintmax_t size = 0;
  int growths = 0;
  for (int i = 0; i < 1200 && growths < 3; ++i) {
    std::error_code error;
    const std::uintmax_t now = std::filesystem::file_size(recording, error);
    if (!error && now > size) {
      size = now;
      ++growths;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

TEST(Run, KilledLeavesEveryFlushedFrameReadable) {
  const TemporaryFolder folder;
  const std::string scene = write_text(folder, "scene.toml", kManyHexapods);
  const std::string recording = folder.file("run.h5");
  Program run({"run", scene, "-o", recording, "--set", "world.duration=1000"});
  wait_for_frames(recording);
  ASSERT_TRUE(run.is_running());
  run.send_signal(SIGKILL);
  EXPECT_EQ(run.finish().exit_code, 128 + SIGKILL);
  const Outcome info = run_gotai({"info", recording, "--json"});
  ASSERT_EQ(info.exit_code, 0) << info.err;
  EXPECT_GT(info.json().at("frames"), 1);
  EXPECT_EQ(info.json().at("complete"), false);
  EXPECT_EQ(run_gotai({"export", recording, "-o", folder.file("run.csv")}).exit_code, 0);
}

TEST(Run, CtrlCFinishesTheFrameAndClosesTheRecording) {
  const TemporaryFolder folder;
  const std::string scene = write_text(folder, "scene.toml", kManyHexapods);
  const std::string recording = folder.file("run.h5");
  Program run({"run", scene, "-o", recording, "--json", "--set", "world.duration=1000"});
  wait_for_frames(recording);
  run.send_signal(SIGINT);
  const Outcome outcome = run.finish();
  EXPECT_EQ(outcome.exit_code, 130);
  EXPECT_THAT(outcome.err, HasSubstr("interrupted"));
  EXPECT_GT(outcome.json().at("steps"), 0);
  EXPECT_GT(run_gotai({"info", recording, "--json"}).json().at("frames"), 1);
}

}  // namespace
}  // namespace gotai::test
