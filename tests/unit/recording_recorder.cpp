// Recording a world and reading it back; resuming; hostile recordings.
#include "gotai/recording/recorder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "gotai/core/error.h"
#include "gotai/core/hash.h"
#include "gotai/recording/checkpoint.h"
#include "gotai/recording/hdf5_file.h"
#include "gotai/recording/recording_reader.h"
#include "support/falling_cubes.h"
#include "support/temporary_folder.h"

namespace gotai::recording {
namespace {

using testing::HasSubstr;

const SceneSource kScene{"scene.toml", "[world]\n", {"time.step=0.01"}};
constexpr RecorderOptions kOften{.fps = 30.0, .contacts = true, .flush = 0.0, .checkpoint = 1e-9};

void run(World& world, Recorder& recorder, double end) {
  while (world.time() < end - 1e-9) recorder.on_step(world, world.step());
}

TEST(Recorder, WhatIsReadIsWhatWasRecorded) {
  test::TemporaryFolder folder;
  const std::string path = folder.file("run.h5");
  World world = test::falling_cubes(2);
  std::vector<double> times;
  std::vector<Pose> poses;
  std::vector<std::string> hashes;
  std::vector<std::size_t> contacts;
  std::size_t steps = 0;
  {
    Recorder recorder(path, world, kScene, {.fps = 30.0, .flush = 1e-3});
    const auto note = [&] {
      if (recorder.frame_count() == times.size()) return;
      times.push_back(world.time());
      poses.push_back(world.bodies().mesh_pose(3));
      hashes.push_back(world.state_hash().hex());
      contacts.push_back(world.contacts().size());
    };
    note();
    for (; world.time() < 1.0 - 1e-9; ++steps) {
      recorder.on_step(world, world.step());
      note();
    }
    recorder.finish(world, "{\"steps\": 100}");
  }
  const RecordingReader recording(path);
  EXPECT_THAT(recording.version(), testing::MatchesRegex("[0-9]+.[0-9]+.[0-9]+"));
  EXPECT_EQ(recording.scene_text(), "[world]\n");
  EXPECT_EQ(recording.overrides(), kScene.overrides);
  EXPECT_EQ(recording.certificate(), "{\"steps\": 100}");
  EXPECT_THAT(recording.settings_json(), HasSubstr("\"level\":3"));
  EXPECT_EQ(recording.fps(), 30.0);
  ASSERT_EQ(recording.bodies().size(), 4u);
  EXPECT_EQ(recording.bodies()[0].geometry, model::Geometry::plane);
  EXPECT_EQ(recording.bodies()[1].half_extent, Vec3(1, 1, 1));
  EXPECT_EQ(recording.bodies()[2].name, "cube 1");
  EXPECT_NEAR(recording.bodies()[2].mass, 1000.0, 1e-9);
  ASSERT_EQ(recording.shapes().size(), 1u);
  const voxel::Shape& shape = *world.shapes()[0];
  EXPECT_EQ(recording.shapes()[0].mesh.triangles, shape.mesh.triangles);
  EXPECT_EQ(recording.shapes()[0].mesh.vertices, shape.mesh.vertices);
  EXPECT_EQ(recording.shapes()[0].voxels[2].size(), shape.pyramid.level(3).size());
  EXPECT_EQ(recording.shapes()[0].grid.edge, shape.pyramid.grid.edge);
  EXPECT_NEAR(recording.shapes()[0].volume, 1.0, 1e-12);

  ASSERT_EQ(recording.frame_count(), 31u) << "frame 0 and 30 per second";
  ASSERT_EQ(times.size(), 31u);
  std::size_t touching = 0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const Frame frame = recording.frame(i);
    EXPECT_EQ(frame.time, times[i]);
    EXPECT_GE(frame.time, static_cast<double>(i) / 30.0 - 1e-9);
    EXPECT_LT(frame.time, static_cast<double>(i) / 30.0 + 0.01);
    EXPECT_EQ(frame.poses[3].p, poses[i].p) << "to the bit";
    EXPECT_EQ(frame.poses[3].q.coeffs(), poses[i].q.coeffs());
    EXPECT_EQ(frame.state_hash, hashes[i]);
    EXPECT_EQ(recording.contacts(i).size(), contacts[i]);
    for (const RecordedContact& contact : recording.contacts(i)) {
      EXPECT_NEAR(contact.normal_W.norm(), 1.0, 1e-6);
      EXPECT_EQ(contact.body_a, 2u);
      ++touching;
    }
  }
  EXPECT_GT(touching, 0u) << "the lower cube lands within the second";
  const StepTable table = recording.steps();
  EXPECT_EQ(table.time.size(), steps);
  EXPECT_EQ(table.dt.back(), 0.01);
  EXPECT_EQ(table.energy.back()[0], world.energy().kinetic);
}

TEST(Recorder, RecordingChangesNothing) {
  test::TemporaryFolder folder;
  World alone = test::falling_cubes(2);
  alone.run_until(1.0);
  World recorded = test::falling_cubes(2);
  Recorder recorder(folder.file("run.h5"), recorded, kScene, kOften);
  while (recorded.step_count() < alone.step_count()) recorder.on_step(recorded, recorded.step());
  EXPECT_EQ(recorded.state_hash(), alone.state_hash());
}

TEST(Recorder, BodiesMayComeAndGo) {
  test::TemporaryFolder folder;
  const std::string path = folder.file("run.h5");
  World world = test::falling_cubes(1);
  {
    Recorder recorder(path, world, kScene, {.fps = 100.0});
    recorder.on_step(world, world.step());
    BodyDescription late;
    late.name = "late";
    late.X_WM.p = Vec3(0, 0, 9);
    world.add_body(late);
    recorder.on_step(world, world.step());
    world.remove_body(world.id(2));
    recorder.on_step(world, world.step());
  }
  const RecordingReader recording(path);
  ASSERT_EQ(recording.bodies().size(), 4u);
  EXPECT_EQ(recording.bodies()[3].name, "late");
  ASSERT_EQ(recording.frame_count(), 4u);
  EXPECT_TRUE(std::isnan(recording.frame(1).poses[3].p.x()));
  EXPECT_NEAR(recording.frame(2).poses[3].p.z(), 9.0, 0.01);
  EXPECT_TRUE(std::isnan(recording.frame(3).poses[2].p.x()));
  EXPECT_EQ(recording.frame(3).poses[3].p, world.bodies().mesh_pose(2).p);
}

TEST(Recorder, AResumedRunEndsInTheSameState) {
  test::TemporaryFolder folder;
  World whole = test::falling_cubes(2);
  const std::string whole_path = folder.file("whole.h5");
  {
    Recorder recorder(whole_path, whole, kScene, kOften);
    run(whole, recorder, 2.0);
    recorder.finish(whole, "{}");
  }
  const std::string path = folder.file("part.h5");
  {
    World world = test::falling_cubes(2);
    Recorder recorder(path, world, kScene, kOften);
    run(world, recorder, 1.234);  // ends without finish(), as after an error
  }
  World world = test::falling_cubes(2);
  {
    Recorder recorder = Recorder::resume(path, world, kOften);
    EXPECT_GT(world.time(), 1.1);
    EXPECT_LT(world.time(), 1.25);
    run(world, recorder, 2.0);
    recorder.finish(world, "{}");
  }
  EXPECT_EQ(world.state_hash(), whole.state_hash());
  const RecordingReader a(whole_path);
  const RecordingReader b(path);
  ASSERT_EQ(a.frame_count(), b.frame_count());
  for (std::size_t i = 0; i < a.frame_count(); ++i) {
    EXPECT_EQ(a.frame(i).state_hash, b.frame(i).state_hash) << i;
    EXPECT_EQ(a.contacts(i).size(), b.contacts(i).size());
  }
  EXPECT_EQ(a.steps().time, b.steps().time);
}

TEST(Recorder, ResumingAnotherSceneIsRefused) {
  test::TemporaryFolder folder;
  const std::string path = folder.file("run.h5");
  {
    World world = test::falling_cubes(2);
    Recorder recorder(path, world, kScene, kOften);
  }
  World other = test::falling_cubes(3);
  try {
    Recorder::resume(path, other, kOften);
    FAIL();
  } catch (const FileError& error) {
    EXPECT_THAT(error.what(), HasSubstr("other bodies"));
  }
}

TEST(RecordingReader, RefusesWhatIsNoRecording) {
  test::TemporaryFolder folder;
  const std::string path = folder.file("a.h5");
  {
    Hdf5File file = Hdf5File::create(path);
    file.write_text("/format", "something else");
    file.flush();
  }
  try {
    const RecordingReader recording(path);
    FAIL();
  } catch (const FileError& error) {
    EXPECT_THAT(error.what(), HasSubstr("something else"));
  }
}

TEST(RecordingReader, SurvivesDamageAnywhere) {
  test::TemporaryFolder folder;
  const std::string path = folder.file("run.h5");
  {
    World world = test::falling_cubes(1);
    Recorder recorder(path, world, kScene, kOften);
    run(world, recorder, 0.3);
  }
  std::ifstream in(path, std::ios::binary);
  const std::string good((std::istreambuf_iterator<char>(in)), {});
  // Metadata and data bytes alike: an answer or a FileError, nothing else.
  for (std::size_t at = 0; at < good.size(); at += at < 3000 ? 11 : good.size() / 150) {
    std::string bad = good;
    bad[at] = static_cast<char>(~bad[at]);
    const std::string damaged = folder.file("damaged.h5");
    std::ofstream(damaged, std::ios::binary) << bad;
    try {
      const RecordingReader recording(damaged);
      for (std::size_t i = 0; i < std::min<std::size_t>(recording.frame_count(), 20); ++i) {
        recording.frame(i);
        recording.contacts(i);
      }
      recording.steps();
    } catch (const FileError&) {
    }
  }
}

TEST(Checkpoint, DamageIsNoticed) {
  Checkpoint checkpoint;
  checkpoint.ids = {3};
  checkpoint.snapshot.x_W = {Vec3(1, 2, 3)};
  checkpoint.snapshot.q_WB = {Quat::Identity()};
  checkpoint.snapshot.v_W = checkpoint.snapshot.L_W = checkpoint.snapshot.w_W = {Vec3::Zero()};
  checkpoint.snapshot.memory.entries = {{1, 2, 99, Vec3(4, 5, 6)}};
  const Vec3 one = Vec3::Ones();
  const Quat turn(0.0, 1.0, 0.0, 0.0);
  checkpoint.snapshot.anchors.pairs = {
      {1, 2, {Vec3(7, 8, 9), turn}, 0.1, {{one, 2 * one, 3 * one, 4 * one, 0.5, 99}}},
      {1, 3, {one, turn}, 0.2, {{one, one, one, one, 1.5, 5}, {one, one, one, 6 * one, 1.0, 7}}}};
  const std::vector<std::uint8_t> bytes = to_bytes(checkpoint);
  const Checkpoint back = from_bytes(bytes, "a.h5");
  EXPECT_EQ(back.snapshot.x_W[0], Vec3(1, 2, 3));
  EXPECT_EQ(back.snapshot.memory.entries[0].feature, 99u);
  ASSERT_EQ(back.snapshot.anchors.pairs.size(), 2u);
  EXPECT_EQ(back.snapshot.anchors.pairs[0].X_BA.q.coeffs(), turn.coeffs());
  EXPECT_EQ(back.snapshot.anchors.pairs[1].reach, 0.2);
  EXPECT_EQ(back.snapshot.anchors.pairs[1].contacts[1].friction_A, 6 * one);
  EXPECT_EQ(to_bytes(back), bytes);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::vector<std::uint8_t> bad = bytes;
    bad[i] ^= 1;
    EXPECT_THROW(from_bytes(bad, "a.h5"), FileError);
    bad.resize(i);
    EXPECT_THROW(from_bytes(bad, "a.h5"), FileError);
  }
}

TEST(Checkpoint, AnotherFormatIsNamed) {
  std::vector<std::uint8_t> bytes = to_bytes(Checkpoint{});
  bytes.resize(bytes.size() - sizeof(Hash128));
  bytes[0] = 1;
  const Hash128 hash = Hasher().bytes(bytes.data(), bytes.size()).digest();
  const auto* begin = reinterpret_cast<const std::uint8_t*>(&hash);
  bytes.insert(bytes.end(), begin, begin + sizeof hash);
  try {
    from_bytes(bytes, "a.h5");
    FAIL();
  } catch (const FileError& error) {
    EXPECT_NE(std::string(error.what()).find("has format 1"), std::string::npos) << error.what();
  }
}

// Found by fuzz_checkpoint: what was left over of an array was dropped without a word.
TEST(Checkpoint, ArraysOfAnotherLengthThanTheBodiesAreRefused) {
  // Version, four counters, two times, lengths of the ids and of the hash: no body, but one number
  // where its place would be.
  constexpr std::size_t kLengthOfPlaces = 4 + 4 * 8 + 2 * 8 + 2 * 8;
  std::vector<std::uint8_t> bytes = to_bytes(Checkpoint{});
  bytes.resize(bytes.size() - sizeof(Hash128));
  bytes.at(kLengthOfPlaces) = 1;
  bytes.insert(bytes.begin() + kLengthOfPlaces + 8, sizeof(double), 0);
  const Hash128 hash = Hasher().bytes(bytes.data(), bytes.size()).digest();
  const auto* begin = reinterpret_cast<const std::uint8_t*>(&hash);
  bytes.insert(bytes.end(), begin, begin + sizeof hash);
  EXPECT_THROW(from_bytes(bytes, "a.h5"), FileError);
}

}  // namespace
}  // namespace gotai::recording
