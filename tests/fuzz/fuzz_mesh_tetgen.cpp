// The two files of a TetGen mesh, one after the other with a zero byte in between.
#include <algorithm>
#include <cstdint>
#include <string_view>

#include "gotai/core/error.h"
#include "gotai/geometry/import.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const std::size_t nodes = std::min(bytes.find('\0'), size);
  try {
    gotai::geometry::detail::read_tetgen({"fuzz.node", bytes.substr(0, nodes)},
                                         {"fuzz.ele", bytes.substr(std::min(nodes + 1, size))});
  } catch (const gotai::FileError&) {
  }
  return 0;
}
