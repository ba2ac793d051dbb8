#include "gotai/view/live_frames.h"

#include <algorithm>
#include <utility>

#include "gotai/view/container.h"
#include "gotai/view/pack.h"
#include "gotai/view/pack_contacts.h"

namespace gotai::view {
namespace {

// Half a minute of frames: who opens the page late still sees how it began.
constexpr std::size_t kKeptFrames = 1800;
constexpr std::chrono::milliseconds kPause{8};  // half a frame of 60 per second
constexpr std::size_t kKeptBytes = std::size_t{256} << 20U;
// More arrows than anybody can tell apart.
constexpr std::size_t kMostContacts = 3000;

void push(std::vector<float>& out, const Vec3& v) {
  for (int k = 0; k < 3; ++k) out.push_back(static_cast<float>(v[k]));
}

void add_contacts(const ContactsView& contacts, const std::string& name,
                  ContainerWriter& container) {
  std::vector<std::uint32_t> body;
  std::vector<float> point;
  std::vector<float> normal;
  std::vector<float> impulse;
  std::vector<float> gap;
  for (const std::size_t i : strongest(contacts, kMostContacts)) {
    body.push_back(contacts.body[2 * i]);
    body.push_back(contacts.body[2 * i + 1]);
    push(point, contacts.point_W[i]);
    push(normal, contacts.normal_W[i]);
    push(impulse, contacts.impulse_W[i]);
    gap.push_back(static_cast<float>(contacts.gap[i]));
  }
  container.add(name + ".body", body);
  container.add(name + ".point", point);
  container.add(name + ".normal", normal);
  container.add(name + ".impulse", impulse);
  container.add(name + ".gap", gap);
}

/// Memory of a frame, nearly.
std::size_t bytes_of(const LiveFrame& live) {
  const FrameView& frame = live.frame;
  const std::size_t per_body = 3 * sizeof(Vec3) + sizeof(Quat);
  const std::size_t per_contact = 3 * sizeof(Vec3) + sizeof(double) + 2 * sizeof(std::uint32_t);
  return frame.x_W.size() * per_body + frame.contacts.gap.size() * per_contact +
         live.steps.size() * (sizeof(CurvePoint) + curves().size() * sizeof(double));
}

}  // namespace

std::string encode(const LiveFrame& live) {
  const FrameView& frame = live.frame;
  std::vector<float> pose;
  std::vector<float> velocity;
  for (std::size_t i = 0; i < frame.x_W.size(); ++i) {
    const Quat& q = frame.q_WB[i];
    push(pose, frame.x_W[i]);
    for (const double c : {q.w(), q.x(), q.y(), q.z()}) pose.push_back(static_cast<float>(c));
    push(velocity, frame.v_W[i]);
    push(velocity, frame.w_W[i]);
  }
  std::vector<float> load;
  for (const double sum : frame.loads()) load.push_back(static_cast<float>(sum));

  ContainerWriter container;
  container.add("pose", pose);
  container.add("velocity", velocity);
  container.add("load", load);
  add_contacts(frame.contacts, "contacts", container);
  add_contacts(apparent_contacts(frame.contacts), "apparent", container);
  nlohmann::json steps = nlohmann::json::array();
  for (const CurvePoint& point : live.steps) {
    nlohmann::json step{{"time", point.time}};
    for (std::size_t c = 0; c < point.values.size(); ++c) step[curves()[c].name] = point.values[c];
    steps.push_back(std::move(step));
  }
  return to_base64(container.finish(
      {{"time", frame.time}, {"bodies", frame.x_W.size()}, {"steps", std::move(steps)}}));
}

void LiveFrames::push(LiveFrame frame) {
  auto shared = std::make_shared<const LiveFrame>(std::move(frame));
  {
    const std::scoped_lock lock(mutex_);
    bytes_ += bytes_of(*shared);
    frames_.push_back(std::move(shared));
    while (frames_.size() > kKeptFrames || (bytes_ > kKeptBytes && frames_.size() > 1)) {
      bytes_ -= bytes_of(*frames_.front());
      frames_.pop_front();
      ++first_;
    }
  }
}

void LiveFrames::close() {
  {
    const std::scoped_lock lock(mutex_);
    closed_ = true;
  }
  closing_.notify_all();
}

bool LiveFrames::is_closed() {
  const std::scoped_lock lock(mutex_);
  return closed_;
}

std::optional<LiveFrames::Next> LiveFrames::next(std::uint64_t number,
                                                 std::chrono::milliseconds patience, bool& closed) {
  std::unique_lock lock(mutex_);
  const auto end = std::chrono::steady_clock::now() + patience;
  const auto is_there = [&] { return closed_ || number < first_ + frames_.size(); };
  // Asking again costs the viewer's thread little; waking it would cost the simulation much.
  while (!is_there() && std::chrono::steady_clock::now() < end)
    closing_.wait_for(lock, std::min(patience, kPause), is_there);
  closed = closed_;
  number = std::max(number, first_);
  if (number >= first_ + frames_.size()) return std::nullopt;
  return Next{number, frames_[number - first_]};
}

}  // namespace gotai::view
