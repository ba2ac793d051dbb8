// Scene files: what they mean, and what every kind of mistake says.
#include "gotai/scene/scene_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ostream>
#include <string>

#include "gotai/core/error.h"

namespace gotai::scene {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

const std::string kShape = "[shapes.block]\ngenerate = \"cube\"\n";
const std::string kBody = "[[bodies]]\nshape = \"block\"\n";

SceneDescription parse(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return parse_scene(text, "folder/scene.toml", overrides);
}

std::string message(const std::string& text, const std::vector<std::string>& overrides = {}) {
  try {
    parse(text, overrides);
  } catch (const FileError& error) {
    return error.what();
  }
  return "no error";
}

TEST(SceneFile, DefaultsAreThoseOfTheSettings) {
  const SceneDescription scene = parse(kShape + kBody);
  EXPECT_EQ(scene.settings.gravity, model::Settings{}.gravity);
  EXPECT_EQ(scene.settings.time.step, 0.0);
  EXPECT_EQ(scene.duration, 5.0);
  EXPECT_FALSE(scene.allow_initial_overlap);
  ASSERT_EQ(scene.bodies.size(), 1u);
  EXPECT_EQ(scene.bodies[0].name, "block 1");
  EXPECT_EQ(scene.bodies[0].body.kind, model::BodyKind::dynamic);
  EXPECT_EQ(scene.shapes[0].prepared_level, 7);
  EXPECT_EQ(scene.materials.materials[0].density, 1000.0);
}

TEST(SceneFile, ReadsEveryTable) {
  const SceneDescription scene = parse(R"(
[world]
gravity = [0, 0, -9.8]
duration = 2.5
allow_initial_overlap = true
[collision]
model = "spheres"
level = 5
[impulse]
method = "impulse-averaged"
contacts = "all"
ridge = 1e-8
[time]
step = 0.01
integrator = "explicit-euler"
[material]
restitution = 0.1
[materials.steel]
friction = 0.2
[materials.wood]
friction = 0.4
density = 700
[[material_pair]]
materials = ["wood", "steel"]
friction = 0.35
[record]
fps = 30
contacts = false
[shapes.block]
generate = "hexapod"
size = 1.0
prepared_level = 6
material = "steel"
[shapes.part]
mesh = "meshes/part.obj"
unit = "mm"
up = "y"
scale = 2
[[plane]]
normal = [0, 0, 2]
[[container]]
inner = [4, 4, 6]
material = "wood"
[[bodies]]
shape = "block"
com_position = [0, 0, 3]
rotation = { axis = [0, 0, 2], degrees = 90 }
velocity = [2, 0, 0]
angular_velocity = [0, 0, 1]
mass = 1.5
[[bodies]]
name = "paddle"
shape = "part"
kind = "kinematic"
[[bodies.key_frames]]
time = 0
position = [1, 0, 0]
[[bodies.key_frames]]
time = 1
position = [2, 0, 0]
rotation = { quaternion = [0, 1, 0, 0] }
[[bodies]]
shape = "part"
poses = "poses.csv"
density = 10
material = { friction = 0.9 }
[[pour]]
shape = ["block", "part"]
count = 20
region = { min = [-1, -1, 2], max = [1, 1, 9] }
seed = 7
)");
  EXPECT_EQ(scene.settings.gravity, Vec3(0, 0, -9.8));
  EXPECT_TRUE(scene.allow_initial_overlap);
  EXPECT_EQ(scene.settings.collision.level, 5);
  EXPECT_EQ(scene.settings.impulse.method, model::ImpulseMethodName::impulse_averaged);
  EXPECT_EQ(scene.settings.time.integrator, model::Integrator::explicit_euler);
  ASSERT_GE(scene.materials.materials.size(), 4u);
  EXPECT_EQ(scene.materials.materials[1].restitution, 0.1)
      << "named materials start from [material]";
  EXPECT_EQ(scene.materials.combine(2, 1).friction, 0.35);
  EXPECT_EQ(scene.record.fps, 30.0);
  EXPECT_EQ(scene.shapes[0].material, 1u);
  EXPECT_EQ(scene.shapes[0].generator.size, 1.0);
  EXPECT_EQ(scene.shapes[1].mesh_path, "folder/meshes/part.obj");
  EXPECT_EQ(scene.shapes[1].load.unit, "mm");
  EXPECT_EQ(scene.planes[0].normal, Vec3::UnitZ());
  EXPECT_EQ(scene.containers[0].material, 2u);

  const BodyDescription& block = scene.bodies[0].body;
  EXPECT_EQ(block.material, 1u) << "the shape's";
  EXPECT_EQ(block.com_position, Vec3(0, 0, 3));
  EXPECT_LT((block.X_WM.q * Vec3::UnitX() - Vec3::UnitY()).norm(), 1e-15);
  EXPECT_EQ(block.mass, 1.5);
  const BodyDescription& paddle = scene.bodies[1].body;
  EXPECT_EQ(paddle.kind, model::BodyKind::kinematic);
  ASSERT_EQ(paddle.motion.size(), 2u);
  EXPECT_EQ(paddle.X_WM.p, Vec3(1, 0, 0));
  EXPECT_EQ(scene.bodies[2].poses_path, "folder/poses.csv");
  EXPECT_EQ(scene.materials.materials[scene.bodies[2].body.material].friction, 0.9);
  EXPECT_EQ(scene.pours[0].shapes, (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(scene.pours[0].count, 20u);
}

TEST(SceneFile, AMisspeltKeyNamesTheNearestAndAllAllowedOnes) {
  const std::string text = kShape + kBody + "[material]\nfricton = 0.5\n";
  EXPECT_THAT(message(text),
              AllOf(StartsWith("folder/scene.toml:6:1: "), HasSubstr("unknown key \"fricton\""),
                    HasSubstr("did you mean \"friction\"?"), HasSubstr("restitution"),
                    HasSubstr("density")));
}

struct Mistake {
  std::string text;
  std::string place;  // "line:column"
  std::string says;
};

void PrintTo(const Mistake& mistake, std::ostream* out) { *out << mistake.text; }

class SceneMistakes : public testing::TestWithParam<Mistake> {};

TEST_P(SceneMistakes, AreRefusedWithPlaceAndReason) {
  const Mistake& mistake = GetParam();
  EXPECT_THAT(message(mistake.text), AllOf(StartsWith("folder/scene.toml:" + mistake.place + ": "),
                                           HasSubstr(mistake.says)));
}

INSTANTIATE_TEST_SUITE_P(
    Every, SceneMistakes,
    testing::Values(
        Mistake{"[world\n", "1:7", ""},  //
        Mistake{"a = 1\na = 2\n", "2:5", "cannot redefine"},
        Mistake{"[wrld]\n", "1:2", "did you mean \"world\"?"},
        Mistake{"[world]\nduration = \"long\"\n", "2:12", "must be a number, not a text"},
        Mistake{"[world]\nduration = -1\n", "2:12", "duration = -1 must be > 0"},
        Mistake{"[world]\nduration = nan\n", "2:12", "must be finite"},
        Mistake{"[world]\ngravity = [0, 1]\n", "2:11", "array of 3 numbers, not of 2"},
        Mistake{"[world]\ngravity = [0, 1, true]\n", "2:18", "must be a number, not a boolean"},
        Mistake{"[world]\nallow_initial_overlap = 1\n", "2:25", "must be true or false"},
        Mistake{"[world]\nduration = 2001-01-01\n", "2:12", "dates"},
        Mistake{"world = 1\n", "1:9", "[world] must be a table"},
        Mistake{"[collision]\nlevel = 10\n", "2:9", "level = 10 must be from 1 to 9"},
        Mistake{"[collision]\nlevel = 2.5\n", "2:9", "must be an integer"},
        Mistake{"[collision]\nmodel = \"sphere\"\n", "2:9", "spheres"},
        Mistake{"[impulse]\nmethod = \"magic\"\n", "2:10", "constraint"},
        Mistake{"[impulse]\npenetration = 0\n", "2:15", "penetration = 0 must be from 1e-6 to 0.5"},
        Mistake{"[impulse]\npenetration = 0.6\n", "2:15", "of the smallest bounding radius"},
        Mistake{"[impulse]\ntension = 1\n", "2:11", "must be true or false"},
        Mistake{"[impulse]\nrolling_resistance = -1\n", "2:22", "must be from 0 to 1"},
        Mistake{"[time]\nstep = \"slow\"\n", "2:8", "must be \"auto\" or seconds"},
        Mistake{"[time]\nstep = 0\n", "2:8", "must be > 0"},
        Mistake{"[material]\nrestitution = 1.5\n", "2:15", "must be from 0 to 1"},
        Mistake{"[materials.default]\n", "1:12", "is the name of [material]"},
        Mistake{"[[material_pair]]\nmaterials = [\"steel\", \"wood\"]\n", "2:14",
                "there is no material \"steel\""},
        Mistake{"[record]\nfps = 0\n", "2:7", "must be > 0"},
        Mistake{"[shapes.a]\nsize = 1\n", "1:9", "needs either mesh"},
        Mistake{"[shapes.a]\ngenerate = \"hexapot\"\n", "2:12", "did you mean \"hexapod\"?"},
        Mistake{"[shapes.a]\nmesh = \"a.obj\"\nunit = \"mil\"\n", "3:8", "Allowed: um, mm, cm"},
        Mistake{"[shapes.a]\ngenerate = \"cube\"\nunit = \"mm\"\n", "3:1", "unknown key \"unit\""},
        Mistake{"[shapes.a]\ngenerate = \"cube\"\nprepared_level = 4\n", "3:18", "is coarser than"},
        Mistake{"[[plane]]\nnormal = [0, 0, 0]\n", "2:10", "must not be zero"},
        Mistake{"[[container]]\n", "1:1", "needs the key \"inner\""},
        Mistake{"[[container]]\ninner = [1, 0, 1]\n", "2:9", "must be > 0"},
        Mistake{"[bodies]\n", "1:1", "must be written as [[bodies]]"},
        Mistake{kBody, "2:9", "there is no shape \"block\"; add [shapes.block]"},
        Mistake{kShape + "[[bodies]]\nshape = \"blok\"\n", "4:9", "did you mean \"block\"?"},
        Mistake{kShape + kBody + "mass = 0\n", "5:8", "must be > 0"},
        Mistake{kShape + kBody + "mass = 1\ndensity = 1\n", "6:11", "either mass or density"},
        Mistake{kShape + kBody + "kind = \"static\"\n", "5:8", "Allowed: dynamic, fixed"},
        Mistake{kShape + kBody + "kind = \"fixed\"\nvelocity = [1, 0, 0]\n", "6:12",
                "only dynamic bodies"},
        Mistake{kShape + kBody + "kind = \"kinematic\"\n", "3:1", "needs [[bodies.key_frames]]"},
        Mistake{kShape + kBody + "position = [0, 0, 0]\ncom_position = [0, 0, 0]\n", "6:16",
                "either position or com_position"},
        Mistake{kShape + kBody + "rotation = { axis = [0, 0, 1] }\n", "5:12",
                "write a rotation as"},
        Mistake{kShape + kBody + "rotation = { quaternion = [0, 0, 0, 0] }\n", "5:27",
                "must have length 1"},
        Mistake{kShape + kBody + "poses = \"a.csv\"\nposition = [0, 0, 1]\n", "6:12",
                "already says where"},
        Mistake{kShape + "[[pour]]\nshape = \"block\"\ncount = 0\n", "5:9", "must be from 1"},
        Mistake{
            kShape +
                "[[pour]]\nshape = \"block\"\ncount = 1\nregion = { min = [0, 0, 1], max = [1, 1, "
                "0] }\n",
            "6:10", "min must not exceed"}));

TEST(SceneFile, KeyFramesAscend) {
  EXPECT_THAT(message(kShape + kBody +
                      "kind = \"kinematic\"\n[[bodies.key_frames]]\ntime = 1\nposition = [0,0,0]\n"
                      "[[bodies.key_frames]]\ntime = 1\nposition = [0,0,1]\n"),
              HasSubstr("must ascend in time"));
}

TEST(SceneFile, ASceneWithoutBodiesIsRefused) {
  EXPECT_THAT(message(kShape), HasSubstr("the scene has no bodies"));
}

TEST(SceneFile, AMissingFileIsNamed) {
  EXPECT_THROW(load_scene("no/such/scene.toml"), FileError);
  EXPECT_THROW(load_scene("."), FileError);
}

TEST(SceneOverride, ReplacesAndAddsValues) {
  const SceneDescription scene =
      parse(kShape + kBody + "[time]\nstep = 0.5\n",
            {"time.step=0.01", "impulse.method=penalty", "bodies.0.position=[0, 0, 4]",
             "impulse.penetration=0.01", "impulse.tension=true", "impulse.rolling_resistance=0.02",
             "materials.ice.friction=0.01", "time.step=auto"});
  EXPECT_EQ(scene.settings.time.step, 0.0);
  EXPECT_EQ(scene.settings.impulse.method, model::ImpulseMethodName::penalty);
  EXPECT_EQ(scene.settings.impulse.penetration, 0.01);
  EXPECT_TRUE(scene.settings.impulse.tension);
  EXPECT_EQ(scene.settings.impulse.rolling_resistance, 0.02);
  EXPECT_EQ(scene.bodies[0].body.X_WM.p, Vec3(0, 0, 4));
  EXPECT_EQ(scene.materials.materials[1].name, "ice");
}

TEST(SceneOverride, MistakesNameTheAssignment) {
  const std::string text = kShape + kBody;
  EXPECT_THAT(message(text, {"time.stp=0.01"}),
              AllOf(StartsWith("--set time.stp=0.01: "), HasSubstr("did you mean \"step\"?")));
  EXPECT_THAT(message(text, {"time.step=-1"}),
              AllOf(StartsWith("--set time.step=-1: "), HasSubstr("must be > 0")));
  EXPECT_THAT(message(text, {"time.step"}), HasSubstr("key=value"));
  EXPECT_THAT(message(text, {"bodies.7.mass=1"}), HasSubstr("array with 1 elements"));
  EXPECT_THAT(message(text, {"bodies.0.shape.x=1"}), HasSubstr("cannot be set inside of a text"));
  EXPECT_THAT(message(text, {"a..b=1"}), HasSubstr("empty part"));
}

}  // namespace
}  // namespace gotai::scene
