// Pose files: what is accepted is finite and has unit quaternions.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "gotai/core/error.h"
#include "gotai/scene/pose_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    for (const gotai::Pose& pose : gotai::scene::parse_poses(text, "fuzz.csv")) {
      if (!pose.p.allFinite() || std::abs(pose.q.norm() - 1.0) > 1e-9) std::abort();
    }
  } catch (const gotai::FileError&) {
  }
  return 0;
}
