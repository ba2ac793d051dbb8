/// @file
/// What the fuzz targets of the mesh formats share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string_view>

#include "gotai/core/error.h"
#include "gotai/geometry/load_mesh.h"

namespace gotai::fuzz {

/// Reads the bytes as the file `name`. Errors of ours are an answer; anything else is a finding.
/// What is accepted must be sound: indices in range, coordinates finite.
inline int read_mesh(const std::filesystem::path& name, const std::uint8_t* data,
                     std::size_t size) {
  try {
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    geometry::validate(geometry::read_mesh(name, bytes).mesh);
  } catch (const FileError&) {
  }
  return 0;
}

}  // namespace gotai::fuzz
