// The results that are kept with the project, and any that a run has just written: complete, as
// programs read them, every figure of the thesis by its number.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

#include "experiment.h"
#include "thesis/scenario.h"

namespace gotai::experiments {
namespace {

namespace fs = std::filesystem;

/// Where the results of one effort are: a file for each experiment.
struct Results {
  std::string name;
  Effort effort;
  std::function<fs::path(const std::string& id)> file;
};

void PrintTo(const Results& results, std::ostream* os) { *os << results.name; }

std::vector<Results> all_results() {
  const fs::path kept = fs::path(GOTAI_SOURCE_DIR) / "experiments" / "results";
  const auto in = [](const fs::path& folder) {
    return [folder](const std::string& id) { return folder / (id + ".json"); };
  };
  std::vector<Results> all{{"quick", Effort::quick, in(kept / "quick")},
                           {"full", Effort::full, in(kept / "full")}};
  // .ci/run names the folder of the quick run that it has made.
  if (const char* fresh = std::getenv("GOTAI_EXPERIMENT_RESULTS"))
    all.push_back({"fresh", Effort::quick, [folder = fs::path(fresh)](const std::string& id) {
                     return folder / id / "results.json";
                   }});
  return all;
}

/// More threads than four are swept only where there are as many processors.
bool everywhere(const Json& point) { return point.value("threads", 1) <= 4; }

bool has_metric(const Record& record, const Json& point) {
  for (const auto& [key, value] : record.items())
    if (!point.contains(key) && key != "wall_s" && key != "cpu_s" && !value.is_null()) return true;
  return false;
}

class ExperimentResults : public testing::TestWithParam<Results> {};

TEST_P(ExperimentResults, HoldOneRecordPerPointWithItsParametersAndMetrics) {
  for (const Experiment& experiment : all_experiments()) {
    SCOPED_TRACE(experiment.id);
    std::ifstream in(GetParam().file(experiment.id));
    ASSERT_TRUE(in) << "no " << GetParam().file(experiment.id);
    const Json result = Json::parse(in);
    EXPECT_EQ(result["experiment"], experiment.id);
    EXPECT_EQ(result["effort"], GetParam().effort == Effort::quick ? "quick" : "full");
    const Json& records = result["results"];
    std::size_t expected = 0;
    for (const Json& point : experiment.sweep(GetParam().effort)) {
      if (!everywhere(point)) continue;
      ++expected;
      const std::vector<Record> found = select(records, point);
      ASSERT_EQ(found.size(), 1U) << point;
      EXPECT_TRUE(has_metric(found[0], point)) << point;
      EXPECT_FALSE(found[0].contains("curves")) << point;
    }
    EXPECT_EQ(std::count_if(records.begin(), records.end(), everywhere), expected);
  }
}

TEST_P(ExperimentResults, SayWhatMadeThemAndThatEveryNumberCameOut) {
  for (const Experiment& experiment : all_experiments()) {
    SCOPED_TRACE(experiment.id);
    const Json result = Json::parse(std::ifstream(GetParam().file(experiment.id)));
    for (const char* key : {"version", "commit", "date", "processor", "wall_s", "cpu_s"})
      EXPECT_TRUE(result["provenance"].contains(key)) << key;
    EXPECT_FALSE(result["verdicts"].empty());
    for (const Json& verdict : result["verdicts"]) EXPECT_TRUE(verdict["passed"]) << verdict;
    EXPECT_TRUE(result["passed"]);
  }
}

TEST_P(ExperimentResults, ShowEveryFigureAndTableOfTheThesisByItsNumber) {
  std::set<std::string> shown;
  std::string tables;
  for (const Experiment& experiment : all_experiments()) {
    const Json result = Json::parse(std::ifstream(GetParam().file(experiment.id)));
    for (const Json& figure : result["figures"]) shown.insert(figure);
    for (const Json& table : result["tables"]) tables += table.get<std::string>() + ",";
  }
  const std::vector<std::pair<int, int>> chapters{{2, 2}, {3, 6}, {4, 10}, {5, 6}, {6, 29}};
  for (const auto& [chapter, last] : chapters)
    for (int k = 1; k <= last; ++k)
      EXPECT_THAT(shown,
                  testing::Contains("Fig. " + std::to_string(chapter) + "-" + std::to_string(k)));
  for (int k = 1; k <= 10; ++k)
    EXPECT_THAT(tables, testing::HasSubstr("6-" + std::to_string(k) + ","));
}

INSTANTIATE_TEST_SUITE_P(All, ExperimentResults, testing::ValuesIn(all_results()),
                         [](const auto& instance) { return instance.param.name; });

TEST(Verdicts, AreMissedByNumbersThatDoNotComeOut) {
  EXPECT_TRUE(within("", 1.02, 1.0, 0.03).passed);
  EXPECT_FALSE(within("", 1.04, 1.0, 0.03).passed);
  EXPECT_FALSE(at_most("", 1.3, 1.2).passed);
  EXPECT_FALSE(at_least("", 0.1, 0.2).passed);
  EXPECT_TRUE(falls_with_level("", {0.3, 0.2, 0.1}, 0.0).passed);
  EXPECT_TRUE(falls_with_level("", {0.3, 1e-4, 2e-4}, 1e-3).passed);
  EXPECT_FALSE(falls_with_level("", {0.3, 0.1, 0.2}, 1e-3).passed);
  EXPECT_TRUE(falls_with_level("", {0.3, 0.1, 0.101}, 1e-3, 2e-3).passed);
  EXPECT_FALSE(falls_with_level("", {0.3, 0.1, 0.103}, 1e-3, 2e-3).passed);
  EXPECT_FALSE(falls_with_level("", {0.3, 0.3, 0.301}, 1e-3, 2e-3).passed);
  EXPECT_FALSE(falls_with_level("", {}, 1.0).passed);
}

}  // namespace
}  // namespace gotai::experiments
