#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "program.h"
#include "scenes.h"

namespace gotai::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

// One cube that falls flat and slides.
constexpr const char* kOneCube = R"(
[world]
duration = 0.3
[collision]
model = "spheres"
level = 3
[time]
step = 0.005
[shapes.cube]
generate = "cube"
prepared_level = 3
[[plane]]
[[bodies]]
shape = "cube"
position = [0, 0, 0.8]
velocity = [0.5, 0, 0]
)";

TEST(Compare, RunsEveryMethodAndMeasuresAgainstTheExactOne) {
  const TemporaryFolder folder;
  const std::string scene = write_text(folder, "scene.toml", kOneCube);
  const std::string csv = folder.file("methods.csv");
  const Outcome outcome = run_gotai({"compare", scene, "--json", "-o", csv});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json rows = outcome.json().at("methods");
  ASSERT_EQ(rows.size(), 8U);
  EXPECT_EQ(rows[0].at("method"), "constraint");
  EXPECT_EQ(rows[0].at("distance"), 0.0);
  EXPECT_EQ(rows[1].at("solver"), "iterative");
  EXPECT_LT(rows[1].at("distance"), 1e-6);
  EXPECT_EQ(rows[2].at("contact_treatment"), "apparent");
  for (const json& row : rows) {
    EXPECT_EQ(row.at("failure"), "") << row.at("method");
    EXPECT_NEAR(row.at("simulated_s"), 0.3, 1e-9);
    EXPECT_GE(row.at("impulse_ms"), 0.0);
    EXPECT_EQ(row.at("plastic_islands"), 0);
    if (row.at("method") == "penalty") {
      EXPECT_GT(row.at("substeps_max"), 1);
    } else {
      EXPECT_GE(row.at("substeps_max"), 1);
    }
  }
  EXPECT_GT(rows[3].at("energy_final"), rows[0].at("energy_final"))
      << "superposed impulses explode";

  std::ifstream in(csv);
  std::string header;
  std::getline(in, header);
  EXPECT_THAT(header, HasSubstr("method,contact_treatment,solver"));
  EXPECT_THAT(header, HasSubstr("distance"));
  int lines = 0;
  for (std::string line; std::getline(in, line);) ++lines;
  EXPECT_EQ(lines, 8);
}

TEST(Compare, TheTableNamesEveryMethod) {
  const TemporaryFolder folder;
  const std::string scene = write_text(folder, "scene.toml", kOneCube);
  const Outcome outcome = run_gotai({"compare", scene, "--set", "world.duration=0.05"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* name :
       {"constraint/all/exact", "constraint/all/iterative", "constraint/apparent",
        "impulse-averaged", "penalty", "sem", "vector-field"}) {
    EXPECT_THAT(outcome.out, HasSubstr(name));
  }
  EXPECT_EQ(outcome.err, "") << "no progress when piped";
}

TEST(Compare, DoesNotOverwriteATable) {
  const TemporaryFolder folder;
  const std::string scene = write_text(folder, "scene.toml", kOneCube);
  const std::string csv = write_text(folder, "methods.csv", "mine");
  const Outcome outcome = run_gotai({"compare", scene, "-o", csv});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("methods.csv"));
}

}  // namespace
}  // namespace gotai::test
