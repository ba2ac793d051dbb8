// Scene files: parsing and reading, not building (that opens files).
#include <cstddef>
#include <cstdint>
#include <string>

#include "gotai/core/error.h"
#include "gotai/scene/scene_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  // The last line is tried as an override, too.
  const std::size_t line = text.find_last_of('\n');
  const std::string last = line == std::string::npos ? "" : text.substr(line + 1);
  try {
    gotai::scene::parse_scene(text, "fuzz.toml");
  } catch (const gotai::FileError&) {
  }
  try {
    gotai::scene::parse_scene(text.substr(0, line), "fuzz.toml", {last});
  } catch (const gotai::FileError&) {
  }
  return 0;
}
