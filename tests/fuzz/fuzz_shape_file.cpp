#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "gotai/core/error.h"
#include "gotai/voxel/shape_file.h"

/// Shape files behind their checksum: whatever is accepted is a shape and is written back as it
/// was.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gotai;
  try {
    const std::span<const std::byte> payload(reinterpret_cast<const std::byte*>(data), size);
    const voxel::Shape shape = voxel::decode_shape(payload, "fuzz");
    const std::vector<std::byte> again = voxel::encode_shape(shape);
    if (!std::equal(again.begin(), again.end(), payload.begin(), payload.end())) std::abort();
  } catch (const FileError&) {
  }
  return 0;
}
