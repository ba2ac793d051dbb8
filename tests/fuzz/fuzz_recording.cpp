// Damaged recordings. The input is a list of edits, three bytes of place and one of value, to a
// small sound recording: mutations reach every part of HDF5's format and of ours.
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "gotai/core/error.h"
#include "gotai/recording/recorder.h"
#include "gotai/recording/recording_reader.h"
#include "support/falling_cubes.h"

namespace {

std::string scratch(const char* name) {
  const std::string file = "gotai-fuzz-" + std::to_string(getpid()) + name;
  return (std::filesystem::temp_directory_path() / file).string();
}

std::string sound_recording() {
  const std::string path = scratch("-sound.h5");
  {
    gotai::World world = gotai::test::falling_cubes(1);
    gotai::recording::Recorder recorder(path, world, {"a.toml", "[world]\n", {}}, {});
    while (world.time() < 0.6) recorder.on_step(world, world.step());
    recorder.finish(world, "{}");
  }
  std::ifstream in(path, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(in)), {});
  std::filesystem::remove(path);
  return bytes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string sound = sound_recording();
  static const std::string path = scratch(".h5");
  std::string bytes = sound;
  for (std::size_t i = 0; i + 4 <= size; i += 4) {
    const std::size_t place = data[i] + 256u * data[i + 1] + 65536u * data[i + 2];
    bytes[place % bytes.size()] = static_cast<char>(data[i + 3]);
  }
  if (size % 4 == 2) bytes.resize(bytes.size() * data[size - 1] / 256);  // truncated
  std::ofstream(path, std::ios::binary) << bytes;
  try {
    const gotai::recording::RecordingReader recording(path);
    for (std::size_t i = 0; i < std::min<std::size_t>(recording.frame_count(), 8); ++i) {
      recording.frame(i);
      recording.contacts(i);
    }
    recording.steps();
    recording.has_checkpoint();
  } catch (const gotai::FileError&) {
  }
  std::filesystem::remove(path);
  return 0;
}
