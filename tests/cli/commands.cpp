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

constexpr const char* kTetrahedron = R"(v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
f 1 3 2
f 1 2 4
f 1 4 3
f 2 3 4
)";

TEST(Check, PrintsWhatARunWillCost) {
  const TemporaryFolder folder;
  const std::string scene = write_text(folder, "scene.toml", kTwoCubes);
  const Outcome outcome = run_gotai({"check", scene, "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json result = outcome.json();
  EXPECT_EQ(result.at("dynamic"), 2);
  EXPECT_EQ(result.at("shapes"), 1);
  EXPECT_EQ(result.at("step_s"), 0.005);
  EXPECT_EQ(result.at("expected_steps"), 100);
  EXPECT_GT(result.at("expected_wall_s"), 0.0);
  EXPECT_GT(result.at("memory_bytes"), 0);
  EXPECT_EQ(result.at("overlaps"), json::array());

  const Outcome text = run_gotai({"check", scene});
  EXPECT_THAT(text.out, HasSubstr("fixed by the scene"));
  EXPECT_THAT(text.out, HasSubstr("none at the start"));
}

TEST(Check, DerivesTheTimeStep) {
  const TemporaryFolder folder;
  const std::string scene = write_text(folder, "scene.toml", kTwoCubes);
  const json coarse =
      run_gotai({"check", scene, "--json", "--set", "time.step=auto", "--set", "time.max_step=1"})
          .json();
  const json fine = run_gotai({"check", scene, "--json", "--set", "time.step=auto", "--set",
                               "time.max_step=1", "--set", "collision.level=4"})
                        .json();
  EXPECT_TRUE(coarse.at("step_derived"));
  EXPECT_GT(coarse.at("step_s"), fine.at("step_s"));
}

TEST(Check, ListsOverlapsAtTheStart) {
  const TemporaryFolder folder;
  const std::string scene = write_text(folder, "scene.toml", kTwoCubes);
  const std::string shifted = "bodies.1.position=[0.2, 0.1, 1.1]";
  const Outcome refused = run_gotai({"check", scene, "--json", "--set", shifted});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, HasSubstr("allow_initial_overlap"));
  ASSERT_GE(refused.json().at("overlaps").size(), 1U);
  const json overlap = refused.json().at("overlaps").at(0);
  EXPECT_GT(overlap.at("depth"), overlap.at("voxel_edge"));
  EXPECT_EQ(overlap.at("refused"), true);

  // Short: hundreds of contacts of a deep overlap take the exact solver a second per step.
  const Outcome accepted =
      run_gotai({"check", scene, "--set", shifted, "--set", "world.allow_initial_overlap=true",
                 "--set", "world.duration=0.01"});
  EXPECT_EQ(accepted.exit_code, 0) << accepted.err;
}

TEST(Shape, PreparesAMeshAndInfoReadsItBack) {
  const TemporaryFolder folder;
  const std::string mesh = write_text(folder, "corner.obj", kTetrahedron);
  const std::string shape = folder.file("corner.shape");
  const Outcome made =
      run_gotai({"shape", mesh, "-o", shape, "--level", "5", "--unit", "cm", "--json"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_NEAR(made.json().at("volume"), 1e-6 / 6.0, 1e-18);
  EXPECT_EQ(made.json().at("levels").size(), 5U);
  EXPECT_EQ(made.json().at("levels").at(0).at("voxels"), 1);

  const Outcome info = run_gotai({"info", shape, "--json"});
  ASSERT_EQ(info.exit_code, 0) << info.err;
  EXPECT_EQ(info.json().at("content"), made.json().at("content"));
  EXPECT_EQ(info.json().at("levels"), made.json().at("levels"));

  EXPECT_EQ(run_gotai({"shape", mesh, "-o", shape}).exit_code, 1) << "overwrites";
  EXPECT_EQ(run_gotai({"shape", mesh, "-o", shape, "--force"}).exit_code, 0);
}

TEST(Shape, EveryCommandSaysWhatWasMadeOfAnImperfectMesh) {
  const TemporaryFolder folder;
  // A cube with a triangular hole in its lid.
  write_text(folder, "cube.obj",
             "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
             "v .5 .5 1\nf 4 3 2 1\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\nf 5 6 9\n"
             "f 6 7 9\nf 7 8 9\n");
  const std::string scene =
      write_text(folder, "scene.toml",
                 "[world]\nduration = 0.02\n[collision]\nlevel = 3\n[time]\nstep = 0.01\n"
                 "[shapes.box]\nmesh = \"cube.obj\"\nprepared_level = 5\n[[bodies]]\n"
                 "shape = \"box\"\n");
  const Outcome made =
      run_gotai({"shape", folder.file("cube.obj"), "-o", folder.file("cube.shape"), "--json"});
  EXPECT_THAT(made.json().at("warnings").dump(),
              testing::AllOf(HasSubstr("not closed: 3 edges"), HasSubstr("counted in voxels")));
  const Outcome check = run_gotai({"check", scene, "--json"});
  EXPECT_THAT(check.json().at("warnings").dump(), HasSubstr("shape box: not closed: 3 edges"));
  EXPECT_THAT(run_gotai({"check", scene}).out, HasSubstr("shape box: not closed: 3 edges"));
  const Outcome run = run_gotai({"run", scene, "--json"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.err, HasSubstr("gotai: warning: shape box: not closed: 3 edges"));
  EXPECT_EQ(run.json().at("bodies"), 1) << "nothing but JSON on standard output";
}

TEST(Info, DescribesAMesh) {
  const TemporaryFolder folder;
  const std::string mesh = write_text(folder, "corner.obj", kTetrahedron);
  const json result = run_gotai({"info", mesh, "--json"}).json();
  EXPECT_EQ(result.at("kind"), "mesh");
  EXPECT_EQ(result.at("triangles"), 4);
  EXPECT_EQ(result.at("closed"), true);
  EXPECT_NEAR(result.at("volume"), 1.0 / 6.0, 1e-15);

  std::string text = kTetrahedron;
  const std::string holed = write_text(folder, "holed.obj", text.substr(0, text.rfind("f ")));
  const Outcome outcome = run_gotai({"info", holed});
  EXPECT_THAT(outcome.out, HasSubstr("not closed"));
  EXPECT_THAT(outcome.out, HasSubstr("3 open edges"));
}

TEST(Info, DescribesARecording) {
  const TemporaryFolder folder;
  const std::string scene = write_text(folder, "scene.toml", kTwoCubes);
  const std::string recording = folder.file("run.h5");
  const Outcome run = run_gotai({"run", scene, "-o", recording, "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json result = run_gotai({"info", recording, "--json"}).json();
  EXPECT_EQ(result.at("kind"), "recording");
  EXPECT_EQ(result.at("complete"), true);
  EXPECT_EQ(result.at("frames"), 31);  // 0.5 s at 60 per second, and the start
  EXPECT_EQ(result.at("certificate").at("state_hash"), run.json().at("state_hash"));
  EXPECT_THAT(run_gotai({"info", recording}).out, HasSubstr("frames"));
}

TEST(Export, WritesCsvOfTheMeshFrames) {
  const TemporaryFolder folder;
  const std::string scene = write_text(folder, "scene.toml", kTwoCubes);
  const std::string recording = folder.file("run.h5");
  ASSERT_EQ(run_gotai({"run", scene, "-o", recording}).exit_code, 0);
  const Outcome outcome = run_gotai({"export", recording, "-o", folder.file("run.csv")});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  std::istringstream csv(read_file(folder.file("run.csv")));
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line, "time,body,px,py,pz,qw,qx,qy,qz");
  std::getline(csv, line);
  EXPECT_THAT(line, testing::StartsWith("0,"));
  EXPECT_THAT(line, HasSubstr(",0,0,0.8,1,0,0,0"));
}

TEST(Export, WritesBinaryGltf) {
  const TemporaryFolder folder;
  const std::string scene = write_text(folder, "scene.toml", kTwoCubes);
  const std::string recording = folder.file("run.h5");
  ASSERT_EQ(run_gotai({"run", scene, "-o", recording}).exit_code, 0);
  const Outcome outcome = run_gotai({"export", recording, "-o", folder.file("run.glb")});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(read_file(folder.file("run.glb")), testing::StartsWith("glTF"));
}

TEST(Export, AnUnknownExtensionIsRefusedWithTheKnownOnes) {
  const TemporaryFolder folder;
  const std::string scene = write_text(folder, "scene.toml", kTwoCubes);
  const std::string recording = folder.file("run.h5");
  ASSERT_EQ(run_gotai({"run", scene, "-o", recording}).exit_code, 0);
  const Outcome outcome = run_gotai({"export", recording, "-o", folder.file("run.fbx")});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr(".glb"));
  EXPECT_THAT(outcome.err, HasSubstr(".csv"));
}

}  // namespace
}  // namespace gotai::test
