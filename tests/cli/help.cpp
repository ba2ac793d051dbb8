#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "program.h"

namespace gotai::test {
namespace {

using testing::HasSubstr;

TEST(Help, ListsEveryCommandAndTheExitCodes) {
  const Outcome outcome = run_gotai({"--help"});
  EXPECT_EQ(outcome.exit_code, 0);
  for (const char* command : {"shape", "check", "run", "view", "render", "info", "export"}) {
    EXPECT_THAT(outcome.out, HasSubstr(std::string("\n  ") + command + " ")) << command;
  }
  EXPECT_THAT(outcome.out, HasSubstr("Exit codes"));
}

TEST(Help, EveryCommandExplainsItselfWithExamples) {
  for (const std::string command : {"shape", "check", "run", "view", "render", "info", "export"}) {
    const Outcome outcome = run_gotai({command, "--help"});
    EXPECT_EQ(outcome.exit_code, 0) << command;
    EXPECT_THAT(outcome.out, HasSubstr("Examples:\n  gotai " + command)) << command;
    EXPECT_EQ(outcome.err, "") << command;
  }
}

TEST(Help, Version) {
  const Outcome outcome = run_gotai({"--version"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.out, testing::MatchesRegex("gotai [0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

TEST(Usage, MistakesAreExplainedAndReturnTwo) {
  const std::vector<std::vector<std::string>> mistakes = {
      {},
      {"rnu", "scene.toml"},
      {"run"},
      {"run", "scene.toml", "--colour"},
      {"run", "scene.toml", "--threads", "0"},
      {"run", "scene.toml", "--threads", "many"},
      {"export", "run.h5"},
      {"shape", "mesh.obj"},
  };
  for (const std::vector<std::string>& words : mistakes) {
    const Outcome outcome = run_gotai(words);
    const std::string line = testing::PrintToString(words);
    EXPECT_EQ(outcome.exit_code, 2) << line;
    EXPECT_EQ(outcome.out, "") << line;
    EXPECT_THAT(outcome.err, HasSubstr("--help")) << line;
  }
}

}  // namespace
}  // namespace gotai::test
