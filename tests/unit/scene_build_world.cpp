// Worlds built from scenes: bodies, pours, initial overlaps, the example scenes.
#include "gotai/scene/build_world.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "gotai/core/error.h"
#include "gotai/scene/scene_file.h"
#include "support/temporary_folder.h"

namespace gotai::scene {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;
using testing::ThrowsMessage;

const std::string kCube =
    "[collision]\nlevel = 3\n[shapes.cube]\ngenerate = \"cube\"\nprepared_level = 3\n";

BuiltScene build(const std::string& text, const BuildOptions& options = {}) {
  return build_world(parse_scene(text, "scene.toml"), options);
}

std::string build_message(const std::string& text) {
  try {
    build(text);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(BuildWorld, BodiesHaveTheStatedPoseMassAndMaterial) {
  const BuiltScene built = build(kCube + R"(
[material]
density = 500
[materials.ice]
density = 900
friction = 0
[[plane]]
[[bodies]]
shape = "cube"
position = [0, 0, 2]
velocity = [1, 0, 0]
angular_velocity = [0, 0, 3]
[[bodies]]
shape = "cube"
com_position = [3, 0, 2]
material = "ice"
[[bodies]]
shape = "cube"
position = [6, 0, 2]
kind = "fixed"
)");
  const World& world = *built.world;
  const model::BodyState& bodies = world.bodies();
  ASSERT_EQ(bodies.size(), 4u);
  EXPECT_NEAR(bodies.inverse_mass[1], 1.0 / 500.0, 1e-15);
  EXPECT_NEAR(bodies.inverse_mass[2], 1.0 / 900.0, 1e-15);
  EXPECT_EQ(bodies.inverse_mass[3], 0.0);
  EXPECT_EQ(bodies.v_W[1], Vec3(1, 0, 0));
  EXPECT_LT((bodies.w_W[1] - Vec3(0, 0, 3)).norm(), 1e-12);
  EXPECT_LT((bodies.x_W[2] - Vec3(3, 0, 2)).norm(), 1e-12);
  EXPECT_EQ(world.body_name(1), "cube 1");
  EXPECT_EQ(world.materials().materials[bodies.material[2]].name, "ice");
  EXPECT_TRUE(built.overlaps.empty());
}

TEST(BuildWorld, PosesComeFromAFile) {
  test::TemporaryFolder folder;
  std::ofstream(folder.file("poses.csv")) << "px,py,pz,qw,qx,qy,qz\n0,0,1,1,0,0,0\n0,0,4,0,0,0,1\n";
  const SceneDescription scene = parse_scene(
      kCube + "[[bodies]]\nshape = \"cube\"\nposes = \"poses.csv\"\n", folder.file("scene.toml"));
  const BuiltScene built = build_world(scene);
  ASSERT_EQ(built.world->bodies().size(), 2u);
  EXPECT_LT((built.world->bodies().x_W[1] - Vec3(0, 0, 4)).norm(), 1e-12);
  EXPECT_EQ(built.world->body_name(1), "cube 1 2");
}

TEST(BuildWorld, MeshFilesAreScaledAndTurned) {
  const std::string path = std::string(GOTAI_SOURCE_DIR) + "/examples/meshes/bracket.obj";
  const SceneDescription scene = parse_scene(
      "[shapes.part]\nmesh = \"" + path + "\"\nunit = \"mm\"\nup = \"y\"\nprepared_level = 6\n" +
          "[[bodies]]\nshape = \"part\"\n",
      "scene.toml", {"shapes.part.size=2"});
  const voxel::Shape shape = prepare_shape(scene.shapes[0]).shape;
  const Box3 box = geometry::bounding_box(shape.mesh);
  EXPECT_NEAR(box.sizes().x(), 2.0, 1e-12) << "80 mm became 2 m";
  EXPECT_NEAR(box.sizes().z(), 1.5, 1e-12) << "60 mm up the file's y";
}

TEST(BuildWorld, SheetsNeedAThickness) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.file("sheet.obj")) << "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
  const std::string text = "[shapes.a]\nmesh = \"sheet.obj\"\n[[bodies]]\nshape = \"a\"\n";
  const auto prepare = [&](const std::string& thickness) {
    return prepare_shape(
        parse_scene(text, folder.file("scene.toml"), {"shapes.a.thickness=" + thickness})
            .shapes[0]);
  };
  EXPECT_THAT([&] { prepare("0"); },
              ThrowsMessage<FileError>(HasSubstr("give the thickness of the sheet")));
  EXPECT_NEAR(prepare("0.1").shape.mass.volume, 0.1, 1e-12);
}

TEST(BuildWorld, SaysWhatItMadeOfAnImperfectMesh) {
  const test::TemporaryFolder folder;
  // A cube whose lid has a hole, with a triangle without area.
  std::ofstream(folder.file("cube.obj"))
      << "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nv .5 .5 1\n"
         "f 4 3 2 1\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\nf 5 6 9\nf 6 7 9\nf 7 8 9\n"
         "f 1 1 2\n";
  const BuiltScene built =
      build_world(parse_scene("[shapes.box]\nmesh = \"cube.obj\"\nprepared_level = 5\n[[bodies]]\n"
                              "shape = \"box\"\n",
                              folder.file("scene.toml"), {"collision.level=4"}));
  EXPECT_THAT(built.repairs, testing::ElementsAre(HasSubstr("shape box: ")));
  EXPECT_THAT(built.warnings, testing::Contains(HasSubstr("3 edges have one face (holes)")));
  EXPECT_THAT(built.warnings, testing::Contains(HasSubstr("counted in voxels")));
  EXPECT_THAT(built.warnings, testing::Each(StartsWith("shape box: ")));
}

TEST(BuildWorld, ErrorsNameThePlaceInTheScene) {
  EXPECT_THAT(build_message("[shapes.a]\nmesh = \"no-such-file.obj\"\n[[bodies]]\nshape = \"a\"\n"),
              HasSubstr("no-such-file.obj"));
  EXPECT_THAT(
      build_message("[shapes.a]\ngenerate = \"torus\"\nthickness = 2\n[[bodies]]\nshape = \"a\"\n"),
      StartsWith("scene.toml:1:9: "));
}

TEST(InitialOverlap, IsListedAndRefusedBeyondOneVoxel) {
  const std::string text = kCube +
                           "[[bodies]]\nname = \"a\"\nshape = \"cube\"\n"
                           "[[bodies]]\nname = \"b\"\nshape = \"cube\"\nposition = [0.4, 0, 0]\n";
  EXPECT_THAT(build_message(text),
              AllOf(HasSubstr("a and b: "), HasSubstr("m deep, a voxel is 0.25 m"),
                    HasSubstr("allow_initial_overlap = true")));
  BuildOptions check;
  check.refuse_overlaps = false;
  const BuiltScene checked = build(text, check);
  ASSERT_EQ(checked.overlaps.size(), 1u);
  EXPECT_TRUE(checked.overlaps[0].is_refused());
  EXPECT_EQ(build("[world]\nallow_initial_overlap = true\n" + text).overlaps.size(), 1u);
}

// Bodies that have no contacts because neither surface faces the other's.
TEST(InitialOverlap, OfABodyInsideAnotherIsRefused) {
  EXPECT_THAT(build_message(kCube + "[shapes.grain]\ngenerate = \"cube\"\nsize = 0.3\n" +
                            "[[bodies]]\nname = \"hull\"\nshape = \"cube\"\n"
                            "[[bodies]]\nname = \"core\"\nshape = \"grain\"\n"),
              HasSubstr("hull and core: "));
}

TEST(InitialOverlap, OfLessThanAVoxelIsListedOnly) {
  const BuiltScene built =
      build(kCube + "[[plane]]\n[[bodies]]\nshape = \"cube\"\nposition = [0, 0, 0.45]\n");
  ASSERT_EQ(built.overlaps.size(), 1u);
  EXPECT_FALSE(built.overlaps[0].is_refused());
  EXPECT_EQ(built.overlaps[0].body_b, "plane 1");
}

const std::string kPour = kCube + R"(
[[container]]
inner = [6, 6, 5]
[[bodies]]
shape = "cube"
kind = "fixed"
position = [0, 0, 0.7]
[[pour]]
shape = "cube"
count = 40
region = { min = [-3, -3, 0], max = [3, 3, 12] }
seed = 5
)";

TEST(Pour, NothingTouchesAtTheStart) {
  const BuiltScene built = build(kPour);
  EXPECT_TRUE(built.overlaps.empty());
  const model::BodyState& bodies = built.world->bodies();
  ASSERT_EQ(bodies.size(), 42u);
  const double radius = built.world->shapes()[0]->voxel_bounding_radius[2];
  for (model::BodyIndex i = 2; i < bodies.size(); ++i) {
    for (model::BodyIndex j = 2; j < i; ++j) {
      EXPECT_GE((bodies.x_W[i] - bodies.x_W[j]).norm(), 2 * radius);
    }
    EXPECT_GE(bodies.x_W[i].z(), radius);
  }
}

TEST(Pour, TheSeedDecides) {
  const std::string other = std::string(kPour).replace(kPour.find("seed = 5"), 8, "seed = 6");
  EXPECT_EQ(build(kPour).world->state_hash(), build(kPour).world->state_hash());
  EXPECT_FALSE(build(kPour).world->state_hash() == build(other).world->state_hash());
}

TEST(Pour, ARegionThatIsTooSmallSaysHowManyItHolds) {
  EXPECT_THAT(build_message(kCube + "[[pour]]\nshape = \"cube\"\ncount = 100\n"
                                    "region = { min = [0, 0, 0], max = [2, 2, 2] }\n"),
              AllOf(StartsWith("scene.toml:6:1: "), HasSubstr("of 100 bodies without overlap"),
                    HasSubstr("enlarge the region")));
}

TEST(Examples, AreValidAndStepWithoutLoss) {
  std::size_t count = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::string(GOTAI_SOURCE_DIR) + "/examples")) {
    if (entry.path().extension() != ".toml") continue;
    SCOPED_TRACE(entry.path().filename().string());
    ++count;
    const BuiltScene built = build_world(load_scene(entry.path().string()));
    for (const InitialOverlap& overlap : built.overlaps) EXPECT_FALSE(overlap.is_refused());
    for (int i = 0; i < 20; ++i) built.world->step();
    for (const Vec3& x : built.world->bodies().x_W) EXPECT_TRUE(x.allFinite());
  }
  EXPECT_GE(count, 7u);
}

}  // namespace
}  // namespace gotai::scene
