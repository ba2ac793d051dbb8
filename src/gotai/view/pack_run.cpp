#include "gotai/view/pack_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "gotai/view/curve_points.h"
#include "gotai/view/pack.h"
#include "gotai/view/pack_contacts.h"
#include "gotai/view/run_header.h"
#include "gotai/view/scale.h"

namespace gotai::view {
namespace {

using nlohmann::json;

// Bytes of one moving body in one frame: position, orientation, velocity, spin, load.
constexpr std::size_t kBodyBytes = 26;

/// Ranges over the kept frames, found in a first pass.
struct Ranges {
  Box3 positions;
  double speed = 0.0;  // largest component [m/s]
  double spin = 0.0;   // largest component [rad/s]
  ContactRanges contacts;
  ContactRanges apparent;
};

std::vector<std::uint32_t> moving_bodies(const RunView& run) {
  std::vector<std::uint32_t> moving;
  for (std::uint32_t i = 0; i < run.bodies.size(); ++i)
    if (run.bodies[i].kind != model::BodyKind::fixed) moving.push_back(i);
  return moving;
}

/// Every stride-th frame, and the last one.
std::vector<std::size_t> kept_frames(std::size_t count, std::size_t most) {
  const std::size_t stride = std::max<std::size_t>(1, (count + most - 1) / most);
  std::vector<std::size_t> kept;
  for (std::size_t f = 0; f < count; f += stride) kept.push_back(f);
  if (count > 0 && kept.back() != count - 1) kept.push_back(count - 1);
  return kept;
}

double largest(const Vec3& v) { return v.cwiseAbs().maxCoeff(); }

/// Arrays of the moving bodies over all kept frames.
class FramePacker {
 public:
  FramePacker(const RunView& run, const Ranges& ranges)
      : moving_(moving_bodies(run)), scale_(ranges.positions, smallest_radius(run)) {
    velocity_step_ = std::max(ranges.speed, 1e-12) / 32767.0;
    spin_step_ = std::max(ranges.spin, 1e-12) / 32767.0;
  }

  void add(const FrameView& frame) {
    times_.push_back(frame.time);
    const std::vector<double> loads = frame.loads();
    for (const std::uint32_t body : moving_) {
      if (!frame.is_present(body)) {
        add_absent();
        continue;
      }
      scale_.push(frame.x_W[body], positions_);
      const auto words = pack_quaternion(frame.q_WB[body]);
      orientations_.insert(orientations_.end(), words.begin(), words.end());
      push(frame.v_W[body], velocity_step_, velocities_);
      push(frame.w_W[body], spin_step_, spins_);
      loads_.push_back(pack_half(loads[body]));
    }
  }

  json finish(ContainerWriter& container) const {
    const std::size_t row = 3 * moving_.size();
    container.add("frames.time", times_);
    container.add("frames.moving", moving_);
    scale_.add("frames.position", positions_, row, container);
    container.add("frames.orientation", orientations_, row);
    container.add("frames.velocity", velocities_, row);
    container.add("frames.spin", spins_, row);
    container.add("frames.load", loads_, moving_.size());
    return {{"count", times_.size()},
            {"position", scale_.to_json()},
            {"velocityStep", velocity_step_},
            {"spinStep", spin_step_}};
  }

  double position_error() const { return scale_.error(); }

 private:
  // The page draws no body whose load is not a number; its place does not matter.
  void add_absent() {
    constexpr std::uint16_t kNotANumber = 0x7e00;
    positions_.insert(positions_.end(), 3, 0);
    const auto words = pack_quaternion(Quat::Identity());
    orientations_.insert(orientations_.end(), words.begin(), words.end());
    velocities_.insert(velocities_.end(), 3, 0);
    spins_.insert(spins_.end(), 3, 0);
    loads_.push_back(kNotANumber);
  }

  static double smallest_radius(const RunView& run) {
    double radius = std::numeric_limits<double>::infinity();
    for (const BodyView& body : run.bodies)
      if (body.kind != model::BodyKind::fixed) radius = std::min(radius, body.radius);
    return radius;
  }

  static void push(const Vec3& v, double step, std::vector<std::int16_t>& out) {
    for (int k = 0; k < 3; ++k) out.push_back(static_cast<std::int16_t>(std::lround(v[k] / step)));
  }

  std::vector<std::uint32_t> moving_;
  PositionScale scale_;
  double velocity_step_ = 0.0;
  double spin_step_ = 0.0;
  std::vector<double> times_;
  std::vector<std::uint32_t> positions_;
  std::vector<std::uint16_t> orientations_;
  std::vector<std::int16_t> velocities_;
  std::vector<std::int16_t> spins_;
  std::vector<std::uint16_t> loads_;
};

Ranges measure(const RunView& run, const FrameSource& frames, const std::vector<std::size_t>& kept,
               const std::function<void(double)>& progress) {
  Ranges ranges;
  const std::vector<std::uint32_t> moving = moving_bodies(run);
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const FrameView frame = frames.read(kept[k]);
    for (const std::uint32_t body : moving) {
      if (!frame.is_present(body)) continue;
      ranges.positions.extend(frame.x_W[body]);
      ranges.speed = std::max(ranges.speed, largest(frame.v_W[body]));
      ranges.spin = std::max(ranges.spin, largest(frame.w_W[body]));
    }
    ranges.contacts.extend(frame.contacts);
    ranges.apparent.extend(apparent_contacts(frame.contacts));
    if (progress) progress(0.4 * static_cast<double>(k + 1) / static_cast<double>(kept.size()));
  }
  return ranges;
}

/// Curves, at most so many points each.
void add_curves(std::span<const model::StepReport> steps, std::size_t most,
                ContainerWriter& container, std::vector<std::string>& notes) {
  const std::vector<CurvePoint> points = curve_points(steps, most);
  if (points.size() < steps.size())
    notes.push_back(
        fmt::format("Charts show one point for every {} steps: the largest contacts, "
                    "overlap, residual and times, the last energies.",
                    (steps.size() + most - 1) / most));
  std::vector<double> times;
  times.reserve(points.size());
  for (const CurvePoint& point : points) times.push_back(point.time);
  container.add("steps.time", times);
  for (std::size_t c = 0; c < curves().size(); ++c) {
    std::vector<float> values;
    values.reserve(points.size());
    for (const CurvePoint& point : points) values.push_back(static_cast<float>(point.values[c]));
    container.add("steps." + curves()[c].name, values);
  }
}

/// Poses of the first frame, for the bodies that never move.
void add_rest_poses(const RunView& run, const FrameSource& frames, ContainerWriter& container) {
  std::vector<float> poses(7 * run.bodies.size(), 0.0F);
  if (!frames.times.empty()) {
    const FrameView first = frames.read(0);
    for (std::size_t i = 0; i < run.bodies.size(); ++i) {
      const Quat& q = first.q_WB[i];
      const Vec3& x = first.x_W[i];
      const std::array<double, 7> pose{x.x(), x.y(), x.z(), q.w(), q.x(), q.y(), q.z()};
      std::ranges::transform(pose, poses.begin() + static_cast<std::ptrdiff_t>(7 * i),
                             [](double value) { return static_cast<float>(value); });
    }
  }
  container.add("bodies.pose", poses);
}

}  // namespace

std::vector<std::uint8_t> pack_run(const RunView& run, const FrameSource& frames,
                                   std::span<const model::StepReport> steps,
                                   const PackOptions& options,
                                   const std::function<void(double)>& progress) {
  ContainerWriter container;
  std::vector<std::string> notes;
  json header = write_run_header(run, container, notes);

  // Base64 takes 4 bytes for 3, and the page itself has its share. What deflate gains is spare.
  const std::size_t fixed =
      container.size() + 1'000'000 + options.curve_points * curves().size() * 4;
  const std::size_t whole = options.page_bytes / 4 * 3;
  const std::size_t budget = whole > fixed ? whole - fixed : 0;
  const std::size_t per_frame = std::max<std::size_t>(1, kBodyBytes * moving_bodies(run).size());
  const std::size_t most = std::max<std::size_t>(2, budget * 3 / 5 / per_frame);
  const std::vector<std::size_t> kept = kept_frames(frames.times.size(), most);
  if (kept.size() < frames.times.size())
    notes.push_back(
        fmt::format("{} of {} recorded frames are kept.", kept.size(), frames.times.size()));

  const Ranges ranges = measure(run, frames, kept, progress);
  const std::size_t used = std::min(budget, per_frame * kept.size());
  FramePacker bodies(run, ranges);
  ContactPacker contacts("contacts", ranges.contacts, run.bodies.size(), (budget - used) * 3 / 4);
  ContactPacker apparent("apparent", ranges.apparent, run.bodies.size(), (budget - used) / 4);
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const FrameView frame = frames.read(kept[k]);
    bodies.add(frame);
    contacts.add(frame.contacts);
    apparent.add(apparent_contacts(frame.contacts));
    if (progress)
      progress(0.4 + 0.6 * static_cast<double>(k + 1) / static_cast<double>(kept.size()));
  }
  notes.push_back(fmt::format("Positions are within {:.2g} mm, orientations within {:.2g}°.",
                              1e3 * bodies.position_error(),
                              kQuaternionError * 180.0 / std::numbers::pi));
  if (contacts.limit() < ranges.contacts.most())
    notes.push_back(
        fmt::format("At most {} contacts of a frame are kept, those with the largest "
                    "impulses.",
                    contacts.limit()));
  add_rest_poses(run, frames, container);
  header["frames"] = bodies.finish(container);
  if (ranges.contacts.total() > 0) header["contacts"] = contacts.finish(container);
  if (ranges.apparent.total() > 0) header["apparent"] = apparent.finish(container);
  add_curves(steps, options.curve_points, container, notes);
  header["notes"] = notes;
  return container.finish(std::move(header));
}

}  // namespace gotai::view
