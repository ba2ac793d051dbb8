// Exports read back by readers of their own: CSV, glTF against the recording, the Khronos
// validator.
#include "gotai/recording/export.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "gotai/core/error.h"
#include "gotai/recording/recorder.h"
#include "gotai/recording/thin_keys.h"
#include "support/falling_cubes.h"
#include "support/temporary_folder.h"

namespace gotai::recording {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// Records cubes for a while.
void record(const std::string& path, World world, double end) {
  Recorder recorder(path, world, {"scene.toml", "", {}}, {.fps = 60.0});
  while (world.time() < end - 1e-9) recorder.on_step(world, world.step());
}

/// 200 shapes in free flight, each with a spin and a velocity of its own: nothing can be thinned
/// away easily. Two kinds of shapes.
World flying_bodies() {
  model::Settings settings;
  settings.collision.model = model::CollisionModel::spheres;
  settings.collision.level = 2;
  settings.time.step = 1.0 / 120.0;
  World world(settings);
  for (const char* name : {"hexapod", "torus"}) {
    world.add_shape(std::make_shared<const voxel::Shape>(
        voxel::make_shape(name, geometry::generate({.shape = name, .size = 1.0}),
                          {.prepared_level = 5, .surface_level = 0})));
  }
  for (int i = 0; i < 200; ++i) {
    BodyDescription body;
    body.shape = static_cast<std::uint32_t>(i % 2);
    const int row = i / 15;
    body.X_WM.p = Vec3(3.0 * (i % 15), 3.0 * row, 0.0);
    body.velocity = Vec3(0.0, 0.0, 5.0 + 0.01 * i);
    body.angular_velocity = Vec3(0.02 * i, 3.0 - 0.01 * i, 1.0);
    world.add_body(body);
  }
  return world;
}

// ---- a reader of GLB files, independent of the writer ------------------------------------------

struct Glb {
  json document;
  std::string data;

  explicit Glb(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(in)), {});
    std::uint32_t json_size = 0;
    std::memcpy(&json_size, bytes.data() + 12, 4);
    document = json::parse(bytes.substr(20, json_size));
    data = bytes.substr(20 + json_size + 8);
  }

  std::vector<double> floats(std::size_t accessor) const {
    const json& a = document["accessors"][accessor];
    const json& view = document["bufferViews"][a["bufferView"].get<std::size_t>()];
    const std::size_t width = a["type"] == "SCALAR" ? 1 : a["type"] == "VEC3" ? 3 : 4;
    std::vector<double> values;
    for (std::size_t i = 0; i < a["count"].get<std::size_t>() * width; ++i) {
      float value = 0;
      std::memcpy(&value, data.data() + view.value("byteOffset", std::size_t{0}) + 4 * i, 4);
      values.push_back(static_cast<double>(value));
    }
    return values;
  }
};

/// Interpolated value of a channel.
struct Channel {
  std::vector<double> times;
  std::vector<double> values;

  std::pair<std::size_t, double> at(double time) const {
    std::size_t i = 0;
    while (i + 2 < times.size() && times[i + 1] <= time) ++i;
    return {i, std::clamp((time - times[i]) / (times[i + 1] - times[i]), 0.0, 1.0)};
  }
  Vec3 position(double time) const {
    const auto [i, s] = at(time);
    const double* v = values.data() + 3 * i;
    return (1 - s) * Vec3(v[0], v[1], v[2]) + s * Vec3(v[3], v[4], v[5]);
  }
  Quat rotation(double time) const {
    const auto [i, s] = at(time);
    const double* v = values.data() + 4 * i;
    return Quat(v[3], v[0], v[1], v[2])
        .normalized()
        .slerp(s, Quat(v[7], v[4], v[5], v[6]).normalized());
  }
};

Quat quaternion(const json& numbers) {
  return Quat(numbers[3].get<double>(), numbers[0].get<double>(), numbers[1].get<double>(),
              numbers[2].get<double>());
}

/// Largest distance of any vertex of any body from its recorded place, in diagonals.
double worst_error(const RecordingReader& recording, const Glb& glb) {
  std::map<std::pair<std::size_t, std::string>, Channel> channels;
  for (const json& animation : glb.document.value("animations", json::array())) {
    for (const json& channel : animation["channels"]) {
      const json& sampler = animation["samplers"][channel["sampler"].get<std::size_t>()];
      channels[{channel["target"]["node"].get<std::size_t>(),
                channel["target"]["path"].get<std::string>()}] = {
          glb.floats(sampler["input"].get<std::size_t>()),
          glb.floats(sampler["output"].get<std::size_t>())};
    }
  }
  const json& nodes = glb.document["nodes"];
  double worst = 0.0;
  for (std::size_t f = 0; f < recording.frame_count(); f += 7) {
    const Frame frame = recording.frame(f);
    for (std::size_t i = 0; i < frame.poses.size(); ++i) {
      const json& node = nodes[i + 1];  // the root comes first
      const json& t = node["translation"];
      Vec3 p(t[0].get<double>(), t[1].get<double>(), t[2].get<double>());
      Quat q = quaternion(node["rotation"]);
      if (channels.contains({i + 1, "translation"})) {
        p = channels[{i + 1, "translation"}].position(frame.time);
      }
      if (channels.contains({i + 1, "rotation"})) {
        q = channels[{i + 1, "rotation"}].rotation(frame.time);
      }
      if (recording.bodies()[i].geometry != model::Geometry::shape) continue;
      const auto& vertices = recording.shapes()[recording.bodies()[i].shape].mesh.vertices;
      Box3 box;
      for (const Vec3& v : vertices) box.extend(v);
      for (std::size_t k = 0; k < vertices.size(); k += 1 + vertices.size() / 64) {
        const double error = (q * vertices[k] + p - frame.poses[i] * vertices[k]).norm();
        worst = std::max(worst, error / box.diagonal().norm());
      }
    }
  }
  return worst;
}

/// What a program of the tests folder prints about a file; null when it fails or cannot be had.
json run_reader(const std::string& program, const std::string& path) {
  const std::string command = fmt::format("{}/tests/{} '{}'", GOTAI_SOURCE_DIR, program, path);
  FILE* pipe = popen(command.c_str(), "r");
  std::string out;
  std::array<char, 4096> part{};
  for (std::size_t n = 0; (n = fread(part.data(), 1, part.size(), pipe)) > 0;) {
    out.append(part.data(), n);
  }
  return pclose(pipe) == 0 ? json::parse(out) : json();
}

TEST(ExportCsv, ReadsBackExactly) {
  test::TemporaryFolder folder;
  record(folder.file("run.h5"), test::falling_cubes(2), 0.3);
  const RecordingReader recording(folder.file("run.h5"));
  export_recording(recording, folder.file("run.csv"));
  std::ifstream in(folder.file("run.csv"));
  std::string line;
  std::getline(in, line);
  EXPECT_EQ(line, "time,body,px,py,pz,qw,qx,qy,qz");
  std::size_t rows = 0;
  for (; std::getline(in, line); ++rows) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    std::vector<double> n(9);
    for (double& number : n) fields >> number;
    const Frame frame = recording.frame(rows / 2);
    const Pose& X = frame.poses[2 + rows % 2];
    EXPECT_EQ(n, (std::vector<double>{frame.time, static_cast<double>(2 + rows % 2), X.p.x(),
                                      X.p.y(), X.p.z(), X.q.w(), X.q.x(), X.q.y(), X.q.z()}));
  }
  EXPECT_EQ(rows, 2 * recording.frame_count());
}

TEST(ExportGltf, TwoHundredBodiesForFiveSeconds) {
  test::TemporaryFolder folder;
  record(folder.file("run.h5"), flying_bodies(), 5.0);
  const RecordingReader recording(folder.file("run.h5"));
  ASSERT_EQ(recording.frame_count(), 301u);
  const std::string path = folder.file("run.glb");
  export_recording(recording, path);
  EXPECT_LT(std::filesystem::file_size(path), 20u << 20);
  const Glb glb(path);
  EXPECT_EQ(glb.document["meshes"].size(), 2u) << "shared by the nodes";
  EXPECT_EQ(glb.document["nodes"].size(), 201u);
  const double error = worst_error(recording, glb);
  RecordProperty("worst_error", fmt::format("{}", error));
  RecordProperty("bytes", fmt::format("{}", std::filesystem::file_size(path)));
  EXPECT_LT(error, 1e-3);
  EXPECT_GT(error, 1e-6) << "keys are thinned";
  const Quat root = quaternion(glb.document["nodes"][0]["rotation"]);
  EXPECT_LT((root * Vec3::UnitZ() - Vec3::UnitY()).norm(), 1e-12) << "+z becomes +Y";
}

TEST(ExportGltf, TheValidatorFindsNothing) {
  test::TemporaryFolder folder;
  record(folder.file("cubes.h5"), test::falling_cubes(2), 1.0);
  record(folder.file("flying.h5"), flying_bodies(), 5.0);
  for (const char* name : {"cubes", "flying"}) {
    const std::string path = folder.file(fmt::format("{}.glb", name));
    export_recording(RecordingReader(folder.file(fmt::format("{}.h5", name))), path);
    const json report = run_reader("gltf/validate.sh", path);
    if (report.is_null()) GTEST_SKIP() << "needs node and gltf-validator (npm ci in tests/gltf)";
    EXPECT_EQ(report["errors"], 0) << report["messages"].dump(1);
    EXPECT_EQ(report["warnings"], 0) << report["messages"].dump(1);
  }
}

TEST(ExportGltf, TextAndBinaryHoldTheSame) {
  test::TemporaryFolder folder;
  record(folder.file("run.h5"), test::falling_cubes(1), 0.2);
  const RecordingReader recording(folder.file("run.h5"));
  export_recording(recording, folder.file("run.gltf"));
  const json text = json::parse(std::ifstream(folder.file("run.gltf")));
  export_recording(recording, folder.file("run.glb"));
  EXPECT_EQ(text["nodes"], Glb(folder.file("run.glb")).document["nodes"]);
  EXPECT_THAT(text["buffers"][0]["uri"].get<std::string>(), HasSubstr("base64"));
}

TEST(ExportVtk, ReadsBackInAnotherLanguage) {
  if (std::system("python3 --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "needs python3";
  test::TemporaryFolder folder;
  record(folder.file("run.h5"), test::falling_cubes(2), 1.0);
  const RecordingReader recording(folder.file("run.h5"));
  export_recording(recording, folder.file("run.pvd"));
  const json sets = run_reader("support/read_vtk.py", folder.file("run.pvd"));
  ASSERT_EQ(sets.size(), 2 * recording.frame_count());
  std::size_t contacts = 0;
  for (std::size_t f = 0; f < recording.frame_count(); ++f) {
    const Frame frame = recording.frame(f);
    const json& bodies = sets[2 * f];
    EXPECT_EQ(bodies["name"], "bodies");
    EXPECT_EQ(bodies["time"].get<double>(), frame.time);
    EXPECT_EQ(bodies["points"], 4 + 8 + 2 * 8) << "floor, tray, two cubes";
    EXPECT_EQ(bodies["cells"], 2 + 10 + 2 * 12);
    Vec3 velocity = Vec3::Zero();
    double places = 0.0;
    for (std::size_t i = 0; i < frame.poses.size(); ++i) {
      if (recording.bodies()[i].geometry != model::Geometry::shape) continue;
      velocity += 8 * frame.v_W[i];  // a cube's vertices turn about its centre
      places += 8 * frame.poses[i].p.sum();
    }
    EXPECT_NEAR(bodies["sums"]["PointData/velocity"].get<double>(), velocity.sum(), 1e-3);
    // The floor is centred on the origin; the tray stands at x = 5 and is 1 high.
    EXPECT_NEAR(bodies["sums"]["Points/points"].get<double>(), places + 8 * 5.0 + 4 * 1.0, 1e-2);
    const json& points = sets[2 * f + 1];
    const auto recorded = recording.contacts(f);
    ASSERT_EQ(points["points"], recorded.size());
    double gaps = 0.0;
    for (const RecordedContact& contact : recorded) gaps += contact.gap;
    EXPECT_NEAR(points["sums"]["PointData/gap"].get<double>(), gaps, 1e-6);
    contacts += recorded.size();
  }
  EXPECT_GT(contacts, 0u);
}

TEST(Export, AnUnknownExtensionNamesTheKnownOnes) {
  test::TemporaryFolder folder;
  record(folder.file("run.h5"), test::falling_cubes(1), 0.02);
  try {
    export_recording(RecordingReader(folder.file("run.h5")), folder.file("run.abc"));
    FAIL();
  } catch (const FileError& error) {
    EXPECT_THAT(error.what(), testing::AllOf(HasSubstr("\".abc\""), HasSubstr(".glb")));
  }
}

TEST(ThinKeys, WhatIsDroppedComesBackByInterpolation) {
  std::vector<double> times;
  std::vector<Vec3> positions;
  std::vector<Quat> rotations;
  for (int i = 0; i <= 200; ++i) {
    const double t = 0.01 * i;
    times.push_back(t);
    positions.push_back(t < 1 ? Vec3(t, 0, -4.9 * t * t) : Vec3(1, 0, -4.9));
    rotations.emplace_back(Eigen::AngleAxisd(t * t, Vec3::UnitZ()));
  }
  const auto kept = thin_positions(times, positions, 1e-3);
  EXPECT_EQ(kept.front(), 0u);
  EXPECT_EQ(kept.back(), 200u);
  EXPECT_LT(kept.size(), 60u);
  for (std::size_t k = 0; k + 1 < kept.size(); ++k) {
    for (std::size_t i = kept[k]; i <= kept[k + 1]; ++i) {
      const double s = (times[i] - times[kept[k]]) / (times[kept[k + 1]] - times[kept[k]]);
      const Vec3 p = (1 - s) * positions[kept[k]] + s * positions[kept[k + 1]];
      EXPECT_LE((p - positions[i]).norm(), 1e-3);
    }
  }
  EXPECT_LT(thin_rotations(times, rotations, 1e-3).size(), 60u);
  EXPECT_EQ(thin_positions(times, std::vector<Vec3>(201, Vec3::Ones()), 1e-3).size(), 1u);
}

}  // namespace
}  // namespace gotai::recording
