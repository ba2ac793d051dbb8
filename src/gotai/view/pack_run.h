/// @file
/// A recorded run as the data of the viewer's page: quantised, thinned when it is large, and saying
/// so.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "gotai/view/run_view.h"

namespace gotai::view {

/// Frames that are read when they are needed, so that a long recording need not fit into memory.
struct FrameSource {
  std::vector<double> times;                         ///< of all frames, ascending [s]
  std::function<FrameView(std::size_t frame)> read;  ///< called up to twice per frame
};

struct PackOptions {
  /// The page stays below this size [bytes] unless the meshes alone are larger.
  std::size_t page_bytes = 30'000'000;
  std::size_t curve_points = 4000;  ///< at most, per curve
};

/// The container for recorded_page(). Positions are rounded to 16 bits over the box in which the
/// bodies move (32 bits when that is coarse for the smallest body), orientations to
/// kQuaternionError; frames and contacts are thinned to fit PackOptions::page_bytes. The page
/// states what was done.
/// @param progress  called with the part that is done, in [0, 1]; may be empty
std::vector<std::uint8_t> pack_run(const RunView& run, const FrameSource& frames,
                                   std::span<const model::StepReport> steps,
                                   const PackOptions& options,
                                   const std::function<void(double)>& progress);

}  // namespace gotai::view
