// `gotai experiment`: the list, mistakes, the JSON that programs read, resuming, the exit code.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "program.h"

namespace gotai::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

TEST(Experiment, ListNamesEveryFigureOfTheThesis) {
  const Outcome outcome = run_gotai({"experiment", "list"});
  EXPECT_EQ(outcome.exit_code, 0);
  for (const char* id : {"fall", "superpose", "throw", "drop-time", "slide", "pile-time",
                         "pile-error", "rocks-error", "polygons", "parallel", "figures",
                         "animations", "cube-on-cube", "stack", "spin", "top", "tunnelling"})
    EXPECT_THAT(outcome.out, HasSubstr(std::string(id) + " ")) << id;
}

TEST(Experiment, UnknownNamesAreAnsweredWithTheNamesThatExist) {
  const Outcome outcome = run_gotai({"experiment", "fal"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("fal"));
  EXPECT_THAT(outcome.err, HasSubstr("superpose"));
}

TEST(Experiment, FallPrintsItsRecordsAndTheyAreThoseOfTheThesis) {
  const TemporaryFolder folder;
  const Outcome outcome =
      run_gotai({"experiment", "fall", "--quick", "--json", "-o", folder.file("results")});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out;
  const json result = outcome.json();
  EXPECT_TRUE(result["passed"].get<bool>());
  for (const char* key : {"version", "commit", "processor", "date"})
    EXPECT_TRUE(result["provenance"].contains(key)) << key;
  const std::vector<double> expected{0.2905, 0.1464, 0.0730, 0.0359, 0.0177};
  std::set<int> levels;
  for (const json& r : result["results"]) {
    ASSERT_TRUE(r["method"].is_string() && r["model"].is_string() && r["level"].is_number() &&
                r["rms"].is_number())
        << r;
    EXPECT_FALSE(r.contains("curves"));
    if (r["method"] != "C") continue;
    const int level = r["level"];
    if (r["model"] == "surface") {
      EXPECT_LT(r["rms"].get<double>(), 0.002) << r;
    }
    if (r["model"] != "spheres" || r["integrator"] != "semi-implicit") continue;
    const double rms = expected[static_cast<std::size_t>(level - 1)];
    EXPECT_NEAR(r["rms"].get<double>(), rms, 0.03 * rms) << r;
    levels.insert(level);
  }
  EXPECT_EQ(levels, (std::set<int>{1, 2, 3, 4, 5}));
  for (const char* file : {"results.json", "results.csv", "report.html", "plot-1.svg"})
    EXPECT_TRUE(fs::exists(fs::path(folder.file("results")) / "fall" / file)) << file;
}

TEST(Experiment, FinishedPointsAreKeptAndMissedNumbersGiveTheExitCode) {
  const TemporaryFolder folder;
  const std::vector<std::string> arguments{"experiment", "top", "--json", "-o",
                                           folder.file("results")};
  ASSERT_EQ(run_gotai(arguments).exit_code, 0);
  // A kept point is taken as it is: change one, and its number is judged.
  const fs::path records = fs::path(folder.file("results")) / "top" / "records";
  int changed = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(records)) {
    json record = json::parse(std::ifstream(entry.path()));
    if (record["integrator"] != "explicit-euler") continue;
    record["error_deg"] = 0.0;
    std::ofstream(entry.path()) << record;
    ++changed;
  }
  ASSERT_GT(changed, 0);
  const Outcome missed = run_gotai(arguments);
  EXPECT_EQ(missed.exit_code, 4);
  EXPECT_FALSE(missed.json()["passed"].get<bool>());

  std::vector<std::string> fresh = arguments;
  fresh.push_back("--fresh");
  EXPECT_EQ(run_gotai(fresh).exit_code, 0);
}

TEST(Experiment, DamagedPointsAreComputedAgain) {
  const TemporaryFolder folder;
  const std::vector<std::string> arguments{"experiment", "superpose", "-o", folder.file("results")};
  ASSERT_EQ(run_gotai(arguments).exit_code, 0);
  const fs::path records = fs::path(folder.file("results")) / "superpose" / "records";
  std::ofstream(fs::directory_iterator(records)->path()) << "{\"method\": ";
  EXPECT_EQ(run_gotai(arguments).exit_code, 0);
}

}  // namespace
}  // namespace gotai::test
