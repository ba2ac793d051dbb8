/// @file
/// Checkpoints as bytes: the state of a world and how far its recording had come. Internal to the
/// module.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gotai/world/snapshot.h"

namespace gotai::recording {

/// Enough to go on with a recording bit for bit.
struct Checkpoint {
  std::uint64_t frames = 0;        ///< rows of /frames
  std::uint64_t steps = 0;         ///< rows of /steps
  std::uint64_t contacts = 0;      ///< rows of /contacts
  std::vector<std::uint32_t> ids;  ///< of the bodies, in column order
  std::string state_hash;          ///< World::state_hash() of the snapshot
  Snapshot snapshot;
};

std::vector<std::uint8_t> to_bytes(const Checkpoint& checkpoint);
/// @param path  for messages
/// @throws FileError when the bytes are no checkpoint or their checksum is wrong
Checkpoint from_bytes(const std::vector<std::uint8_t>& bytes, const std::string& path);

}  // namespace gotai::recording
