/// @file
/// The wrenches that a reduction chooses from, eight candidates at a time.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gotai/collision/surface_search.h"

namespace gotai::collision {

/// Per candidate, in single precision; padded to whole packets with candidates that are never
/// wanted.
struct WrenchLanes {
  std::array<std::vector<float>, 6> wrench;  ///< normal, moment / length
  std::vector<float> reaches;                ///< gap above the deepest / reach
  std::vector<float> weight;                 ///< 1 for the deepest, less above it
  std::vector<float> distance;         ///< squared, to the nearest kept wrench; -1 for kept ones
  std::vector<float> likeness;         ///< squared distance of wrench and gap to `nearest`
  std::vector<std::uint32_t> nearest;  ///< position among the kept of the one most alike
};

/// The candidate that is wanted most, and how far any wrench is from all that are kept.
struct FarthestWrench {
  static constexpr std::uint32_t kNone = 0xffffffff;
  std::uint32_t index = kNone;  ///< kNone: all are as good as kept
  float squared = 0.0F;         ///< largest of the squared distances
};

/// Keeps a candidate: updates the distances of all, and finds what is farthest, weighted. Ties go
/// to the smaller index; every kernel gives the same bits.
/// @param position  of the chosen one among the kept
/// @param same      squared distance up to which wrenches are one
FarthestWrench keep_wrench(WrenchLanes& lanes, std::uint32_t chosen, std::uint32_t position,
                           float same, Kernel kernel = Kernel::automatic);

}  // namespace gotai::collision
