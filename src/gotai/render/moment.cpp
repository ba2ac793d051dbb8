#include "gotai/render/moment.h"

#include <algorithm>
#include <utility>

#include "gotai/core/error.h"

namespace gotai::render {

view::FrameView moment_at(const view::FrameSource& frames, double time) {
  const std::vector<double>& times = frames.times;
  if (times.empty()) throw InvalidArgument("recording", "0 frames", "must have at least one frame");
  const auto after = std::ranges::upper_bound(times, time);
  if (after == times.begin()) return frames.read(0);
  const auto index = static_cast<std::size_t>(after - times.begin()) - 1;
  if (after == times.end() || times[index] == time) return frames.read(index);

  view::FrameView earlier = frames.read(index);
  view::FrameView later = frames.read(index + 1);
  const double f = (time - times[index]) / (times[index + 1] - times[index]);
  const bool later_is_nearer = f > 0.5;
  view::FrameView& nearer = later_is_nearer ? later : earlier;
  for (std::size_t i = 0; i < earlier.x_W.size() && i < later.x_W.size(); ++i) {
    if (!earlier.is_present(i) || !later.is_present(i)) continue;
    const Vec3 x = earlier.x_W[i] + f * (later.x_W[i] - earlier.x_W[i]);
    const Quat q = earlier.q_WB[i].slerp(f, later.q_WB[i]);
    nearer.x_W[i] = x;
    nearer.q_WB[i] = q;
  }
  nearer.time = time;
  return std::move(nearer);
}

Extent measure(const view::RunView& run, const view::FrameSource& frames, std::size_t count) {
  std::vector<view::FrameView> moments;
  const std::size_t have = frames.times.size();
  const std::size_t take = std::min(count, have);
  for (std::size_t k = 0; k < take; ++k)
    moments.push_back(frames.read(take > 1 ? k * (have - 1) / (take - 1) : 0));
  return measure(run, moments);
}

}  // namespace gotai::render
