// The seeds of the fuzzers and the inputs that once broke a reader must be read or refused.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include "gotai/core/error.h"
#include "gotai/geometry/import.h"
#include "gotai/geometry/load_mesh.h"

namespace gotai::geometry {
namespace {

namespace fs = std::filesystem;

void read_or_refuse(const std::string& target, const std::string& bytes) {
  static const std::map<std::string, std::string> names = {
      {"mesh_gltf", "fuzz.gltf"}, {"mesh_gmsh", "fuzz.msh"}, {"mesh_medit", "fuzz.mesh"},
      {"mesh_obj", "fuzz.obj"},   {"mesh_off", "fuzz.off"},  {"mesh_ply", "fuzz.ply"},
      {"mesh_stl", "fuzz.stl"},   {"mesh_vtk", "fuzz.vtk"}};
  try {
    if (target == "mesh_tetgen") {
      const std::size_t nodes = std::min(bytes.find('\0'), bytes.size());
      detail::read_tetgen(
          {"fuzz.node", std::string_view(bytes).substr(0, nodes)},
          {"fuzz.ele", std::string_view(bytes).substr(std::min(nodes + 1, bytes.size()))});
    } else {
      validate(read_mesh(names.at(target), bytes).mesh);
    }
  } catch (const FileError&) {
  }
}

TEST(FuzzCorpus, IsReadOrRefused) {
  std::size_t files = 0;
  for (const char* kind : {"corpus", "regressions"}) {
    const fs::path folder = fs::path(GOTAI_SOURCE_DIR) / "tests/fuzz" / kind;
    if (!fs::exists(folder)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      const std::string target = entry.path().parent_path().filename().string();
      if (!entry.is_regular_file() || !target.starts_with("mesh_")) continue;
      SCOPED_TRACE(entry.path().string());
      std::ifstream in(entry.path(), std::ios::binary);
      const std::string bytes{std::istreambuf_iterator<char>(in), {}};
      EXPECT_NO_THROW(read_or_refuse(target, bytes));
      ++files;
    }
  }
  EXPECT_GT(files, 20U);
}

}  // namespace
}  // namespace gotai::geometry
