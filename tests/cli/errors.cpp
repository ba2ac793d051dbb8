#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "program.h"
#include "scenes.h"

namespace gotai::test {
namespace {

using testing::HasSubstr;

// A scene's text with one part replaced.
std::string edited(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::invalid_argument(from);
  return text.replace(at, from.size(), to);
}

struct Mistake {
  const char* from;
  const char* to;
  std::vector<const char*> messages;  ///< parts of the message
};

TEST(BadScene, EveryMistakeIsNamedWithItsPlaceAndWhatIsAllowed) {
  const std::vector<Mistake> mistakes = {
      {"level = 3", "level = ", {"scene.toml:5:"}},
      {"level = 3", "levle = 3", {"scene.toml:5:1", "levle", "level"}},
      {"level = 3", "level = \"three\"", {"scene.toml:5:", "a text", "integer"}},
      {"level = 3", "level = 10", {"scene.toml:5:", "10"}},
      {"level = 3", "level = 5", {"level", "5", "4"}},
      {"duration = 0.5", "duration = -1", {"scene.toml:3:", "-1", "> 0"}},
      {"step = 0.005", "step = \"fast\"", {"scene.toml:7:", "fast", "auto"}},
      {"\"cube\"\nprepared", "\"cubed\"\nprepared", {"scene.toml:9:", "cubed", "cube"}},
      {"generate = \"cube\"", "mesh = \"nowhere.obj\"", {"nowhere.obj"}},
      {"shape = \"cube\"\nposition = [0, 0, 0.8]",
       "shape = \"cub\"\nposition = [0, 0, 0.8]",
       {"cub", "cube"}},
      {"position = [0, 0, 0.8]", "position = [0, 0]", {"scene.toml:14:", "3"}},
      {"position = [0, 0, 0.8]", "mass = -2", {"scene.toml:14:", "-2"}},
      {"[0.2, 0.1, 2.3]", "[0.2, 0.1, 1.1]", {"overlap", "allow_initial_overlap"}},
  };
  const TemporaryFolder folder;
  for (const Mistake& mistake : mistakes) {
    const std::string scene =
        write_text(folder, "scene.toml", edited(kTwoCubes, mistake.from, mistake.to));
    const Outcome outcome = run_gotai({"run", scene, "-o", folder.file("never.h5")});
    EXPECT_EQ(outcome.exit_code, 1) << mistake.to;
    EXPECT_EQ(outcome.out, "") << mistake.to;
    for (const char* message : mistake.messages) {
      EXPECT_THAT(outcome.err, HasSubstr(message)) << mistake.to;
    }
    EXPECT_FALSE(std::filesystem::exists(folder.file("never.h5"))) << mistake.to;
  }
}

TEST(BadScene, AMistakeInSetNamesTheAssignment) {
  const TemporaryFolder folder;
  const std::string scene = write_text(folder, "scene.toml", kTwoCubes);
  for (const char* assignment : {"collision.levle=3", "collision.level=high", "nonsense"}) {
    const Outcome outcome = run_gotai({"run", scene, "--set", assignment});
    EXPECT_EQ(outcome.exit_code, 1) << assignment;
    EXPECT_THAT(outcome.err, HasSubstr(assignment));
  }
}

TEST(BadFile, MissingAndForeignFilesAreNamed) {
  const TemporaryFolder folder;
  const std::string text = write_text(folder, "notes.txt", "not a mesh, not a recording");
  const std::string missing = folder.file("missing.h5");
  const std::vector<std::vector<std::string>> lines = {
      {"info", text},
      {"info", missing},
      {"run", missing},
      {"check", missing},
      {"shape", text, "-o", folder.file("a.shape")},
      {"shape", missing, "-o", folder.file("b.shape")},
      {"export", text, "-o", folder.file("c.glb")},
      {"export", missing, "-o", folder.file("d.glb")},
  };
  for (const std::vector<std::string>& words : lines) {
    const Outcome outcome = run_gotai(words);
    const std::string line = testing::PrintToString(words);
    EXPECT_EQ(outcome.exit_code, 1) << line;
    EXPECT_EQ(outcome.out, "") << line;
    EXPECT_THAT(outcome.err, HasSubstr(words[1])) << line;
  }
}

}  // namespace
}  // namespace gotai::test
