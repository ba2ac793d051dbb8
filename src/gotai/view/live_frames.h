/// @file
/// The frames of a running world, between the simulation and the threads that send them. Internal
/// to view.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "gotai/view/curve_points.h"
#include "gotai/view/run_view.h"

namespace gotai::view {

/// A frame and the measurements of the steps since the one before.
struct LiveFrame {
  FrameView frame;
  std::vector<CurvePoint> steps;
};

/// The text of a frame as viewer/src/data/live.ts reads it: a container in base64.
std::string encode(const LiveFrame& frame);

/// Keeps the last frames, each with a number, as far as memory is worth it. Every viewer reads at
/// its own pace.
class LiveFrames {
 public:
  void push(LiveFrame frame);
  /// No more frames will come.
  void close();
  bool is_closed();

  struct Next {
    std::uint64_t number = 0;
    std::shared_ptr<const LiveFrame> frame;
  };
  /// The oldest kept frame with at least this number; waits for it.
  /// @returns nothing when the time is over; `closed` says whether there will be more
  std::optional<Next> next(std::uint64_t number, std::chrono::milliseconds patience, bool& closed);

 private:
  std::mutex mutex_;
  std::condition_variable closing_;
  std::deque<std::shared_ptr<const LiveFrame>> frames_;
  std::uint64_t first_ = 0;  // number of frames_[0]
  std::size_t bytes_ = 0;    // of frames_
  bool closed_ = false;
};

}  // namespace gotai::view
