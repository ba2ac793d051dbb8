// Real and damaged meshes: the small ones from tests/data/meshes always, all of them where the
// reference assets are at hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <ctime>
#include <map>
#include <regex>

#include "gotai/core/error.h"
#include "gotai/geometry/load_mesh.h"
#include "support/golden.h"

namespace gotai::geometry {
namespace {

namespace fs = std::filesystem;

/// A line of the manifest; fields may be quoted.
std::vector<std::string> split_csv(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') {
      quoted = !quoted;
    } else if (line[i] == ',' && !quoted) {
      fields.emplace_back();
    } else {
      fields.back() += line[i];
    }
  }
  return fields;
}

using Row = std::map<std::string, std::string>;

/// The manifest's rows of one folder ("meshes" or "dirty"), by file name; empty without assets.
std::map<std::string, Row> manifest(const std::string& folder) {
  std::map<std::string, Row> rows;
  std::ifstream in(test::shared_dir() / "assets/MANIFEST.csv");
  std::string line;
  if (!std::getline(in, line)) return rows;
  const std::vector<std::string> names = split_csv(line);
  while (std::getline(in, line)) {
    const std::vector<std::string> fields = split_csv(line);
    Row row;
    for (std::size_t i = 0; i < names.size() && i < fields.size(); ++i) row[names[i]] = fields[i];
    if (row["folder"] == folder) rows[row["name"]] = row;
  }
  return rows;
}

void expect_counts(const MeshReport& report, const Row& row) {
  EXPECT_EQ(report.file_vertices, std::stoul(row.at("vertices")));
  EXPECT_EQ(report.file_triangles, std::stoul(row.at("faces")));
  EXPECT_EQ(report.file_tetrahedra, std::stoul(row.at("tets")));
}

TEST(Assets, EveryCleanMeshLoadsWithItsVolumeAndCounts) {
  const auto rows = manifest("meshes");
  if (rows.empty()) GTEST_SKIP() << "no reference assets";
  double worst = 0.0;
  for (const auto& [name, row] : rows) {
    SCOPED_TRACE(name);
    const MeshReport report =
        load_mesh(test::shared_dir() / "assets/meshes" / name, {.unit = "m"}).report;
    expect_counts(report, row);
    EXPECT_TRUE(report.closed && report.oriented && report.balanced && report.is_solid());
    EXPECT_EQ(report.components, std::stoul(row.at("components")));
    EXPECT_EQ(report.self_intersections, 0U);
    const double volume = std::stod(row.at("volume"));
    worst = std::max(worst, std::abs(report.volume / volume - 1.0));
    EXPECT_NEAR(report.volume / volume, 1.0, 1e-6);
  }
  RecordProperty("meshes", static_cast<int>(rows.size()));
  RecordProperty("worst_relative_volume_error", std::to_string(worst));
  std::printf("%zu meshes, worst relative volume error %.2g\n", rows.size(), worst);
}

/// What must be said about each damaged file: in the error that refuses it ("! ..."), or in the
/// repairs and warnings of its report.
const std::map<std::string, std::vector<std::string>> kFindings = {
    {"abduction_robot.stl",
     {"walls without thickness", "holes", "more than two", "crosses itself"}},
    {"box_infinite.glb", {"! must be finite"}},
    {"bunny_holes.obj", {"42 edges have one face \\(holes\\)"}},
    {"cray_huge.obj", {"largest extent is 5.08e\\+04 m"}},
    {"dragon_nonmanifold.stl", {"holes", "97 edges have more than two", "244 pairs"}},
    {"empty.ply", {"! no faces"}},
    {"empty.stl", {"! no faces"}},
    {"fuze_badrows.ply", {}},  // the declared part of each row is sound
    {"hourglass.obj", {}},     // a vertex joins two closed parts: the solid is well defined
    {"index_out_of_range.obj", {"!:28: vertex index 0"}},
    {"inverted_tet.msh", {"re-oriented 1 inverted tetrahedra of 6"}},
    {"letter_c_dup.obj", {"dropped 200 triangles that repeat"}},
    {"liver_inside_out.vtk", {"turned 4 of 4 closed pieces that were inside out"}},
    {"made_bad_tets.mesh", {"!:5376: .*vertex 999998"}},
    {"made_count_double.stl", {"! number of facets is 5656, but there is room for 2828"}},
    {"made_flat.obj", {"triangles are flat", "encloses no volume", "crosses itself"}},
    {"made_index_zero.obj", {"!:221: vertex index 0; OBJ counts from 1"}},
    {"made_inside_out.obj", {"inside out"}},
    {"made_inverted_tets.mesh", {"re-oriented 110 inverted tetrahedra"}},
    {"made_nan.stl", {"! vertex 21 .*finite"}},
    {"made_nan_inf.obj", {"!:103: .*finite"}},
    {"made_random_flips.obj", {"reversed 250 triangles"}},
    {"made_tiny_1e-12.obj", {"largest extent is 2.17e-12 m"}},
    {"made_truncated.glb", {"! should have 483692 bytes, but has 200000"}},
    {"made_truncated.ply", {"! truncated"}},
    {"made_truncated.stl", {"! number of facets is 2828, but there is room for 1696"}},
    {"made_truncated41.msh", {"! truncated"}},
    {"made_wrong_count.off", {"! its counts are wrong"}},
    {"mfem_not_medit.mesh", {"! MFEM mesh; convert"}},
    {"moebius.obj", {"only one side", "holes"}},
    {"msh41_missing_node.msh", {"!:38: .*EndNodes"}},
    {"multibody.stl", {"disagreed with their neighbours"}},
    {"nan_color.obj", {}},  // only the colours are NaN
    {"nonmanifold_crash.obj", {"repeat an earlier one", "flat", "more than two", "crosses itself"}},
    {"off_outofmemory.off", {"!:2: the number of vertices is 353535235358"}},
    {"shark_nonmanifold.msh", {"1 edge has more than two faces"}},
    {"solid_header.stl", {}},  // valid binary STL
    {"soup.stl", {"holes", "1248 pairs"}},
    {"spider_ascii.stl", {"dropped 56 triangles", "holes", "disagree on which side", "317 pairs"}},
    {"suzanne.ply", {"holes", "98 pairs"}},
    {"teapot.obj", {"holes", "161 pairs"}},
    {"truck.obj", {"holes", "more than two", "424 pairs"}},
    {"xml_in.vtk", {"! XML"}},
};

struct Outcome {
  bool refused = false;
  std::string text;
  MeshReport report;
};

Outcome load(const fs::path& path) {
  Outcome outcome;
  try {
    outcome.report = load_mesh(path).report;
    for (const std::string& s : outcome.report.repairs) outcome.text += s + "\n";
    for (const std::string& s : outcome.report.warnings) outcome.text += s + "\n";
  } catch (const FileError& error) {
    outcome.refused = true;
    outcome.text = error.what();
  }
  return outcome;
}

void expect_findings(const fs::path& path) {
  SCOPED_TRACE(path.filename().string());
  ASSERT_TRUE(kFindings.contains(path.filename().string())) << "add the file to the table";
  const std::vector<std::string>& findings = kFindings.at(path.filename().string());
  const Outcome outcome = load(path);
  const bool should_refuse = !findings.empty() && findings[0][0] == '!';
  EXPECT_EQ(outcome.refused, should_refuse) << outcome.text;
  if (should_refuse) {
    EXPECT_THAT(outcome.text, ::testing::StartsWith(path.string() + ":"));
  }
  for (std::string finding : findings) {
    if (should_refuse) finding.erase(0, 1);
    if (finding.starts_with(" ")) finding.erase(0, 1);
    EXPECT_TRUE(std::regex_search(outcome.text, std::regex(finding))) << finding << " not in\n"
                                                                      << outcome.text;
  }
  if (findings.empty()) {
    EXPECT_TRUE(outcome.report.is_solid());
  }
}

TEST(Assets, EveryDamagedMeshIsNamedOrRefusedInTime) {
  const auto rows = manifest("dirty");
  if (rows.empty()) GTEST_SKIP() << "no reference assets";
  std::size_t refused = 0;
  for (const auto& [name, row] : rows) {
    const fs::path path = test::shared_dir() / "assets/dirty" / name;
    // Processor time: the machine may be busy with other things.
    const std::clock_t start = std::clock();
    expect_findings(path);
    EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, 5.0) << name;
    const Outcome outcome = load(path);
    if (outcome.refused) ++refused;
    if (!outcome.refused && !row.at("vertices").empty()) {
      SCOPED_TRACE(name);
      expect_counts(outcome.report, row);
    }
  }
  std::printf("%zu damaged meshes: %zu loaded, %zu refused\n", rows.size(), rows.size() - refused,
              refused);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  EXPECT_LT(usage.ru_maxrss, 1024 * 1024) << "KiB";
}

TEST(Assets, SmallDamagedMeshesOfTheTestData) {
  for (const auto& entry : fs::directory_iterator(test::data_dir() / "meshes"))
    if (kFindings.contains(entry.path().filename().string())) expect_findings(entry.path());
}

TEST(Assets, SmallCleanMeshesOfTheTestData) {
  const std::map<std::string, double> volumes = {{"cube22bin.msh", 1.0},
                                                 {"cube41bin.msh", 1.0},
                                                 {"escher.vtk", 6.43141635},
                                                 {"testplate.glb", 0.000447851255}};
  for (const auto& [name, volume] : volumes) {
    const MeshReport report = load_mesh(test::data_dir() / "meshes" / name).report;
    EXPECT_TRUE(report.is_solid()) << name;
    EXPECT_NEAR(report.volume / volume, 1.0, 1e-6) << name;
  }
}

}  // namespace
}  // namespace gotai::geometry
