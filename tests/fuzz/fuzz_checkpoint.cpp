// Checkpoints: the checksum is made right, so that the parser behind it is reached.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "gotai/core/error.h"
#include "gotai/core/hash.h"
#include "gotai/recording/checkpoint.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::uint8_t> bytes(data, data + size);
  const gotai::Hash128 hash = gotai::Hasher().bytes(bytes.data(), bytes.size()).digest();
  const auto* begin = reinterpret_cast<const std::uint8_t*>(&hash);
  bytes.insert(bytes.end(), begin, begin + sizeof hash);
  try {
    const gotai::recording::Checkpoint checkpoint = gotai::recording::from_bytes(bytes, "fuzz.h5");
    if (gotai::recording::to_bytes(checkpoint) != bytes) std::abort();
  } catch (const gotai::FileError&) {
  }
  return 0;
}
