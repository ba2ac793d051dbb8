#include "gotai/view/live_server.h"

#include <fmt/format.h>
#include <httplib.h>

#include <atomic>
#include <charconv>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include "gotai/core/error.h"
#include "gotai/core/stopwatch.h"
#include "gotai/view/live_frames.h"
#include "gotai/view/page.h"
#include "gotai/view/run_header.h"

namespace gotai::view {
namespace {

using std::chrono::milliseconds;

// A chart has no room for more points; runs may take thousands of steps for a frame.
constexpr std::size_t kCurvePointsPerFrame = 4;

/// A page that plays in real time drowns in the frames of a run that is much faster: it gets them
/// at most so many times as fast as it plays them.
class Pace {
 public:
  void sent(double time) {
    if (!begin_) begin_ = time;
    ahead_ = time - *begin_ - kHeadStart - kSpeed * watch_.seconds();
  }
  void wait() const {
    if (ahead_ <= 0.0) return;
    std::this_thread::sleep_for(std::chrono::duration<double>(std::min(ahead_ / kSpeed, 0.1)));
  }

 private:
  static constexpr double kHeadStart = 0.5;  // [s] of the run
  static constexpr double kSpeed = 3.0;
  Stopwatch watch_;
  std::optional<double> begin_;
  double ahead_ = 0.0;  // [s] of the run
};

/// Lets frames take a small part of the run's time.
class Budget {
 public:
  explicit Budget(double seconds) : seconds_(seconds), most_(seconds + kReserve) {}

  void earn(double step_seconds) { seconds_ = std::min(most_, seconds_ + kPart * step_seconds); }
  bool is_enough() const { return seconds_ >= 0.0; }
  /// A frame that was held up by another program does not keep later ones away for long.
  void spend(double seconds) { seconds_ = std::max(-kReserve, seconds_ - seconds); }

 private:
  static constexpr double kPart = 0.025;
  static constexpr double kReserve = 5e-4;  // [s]
  double seconds_;
  double most_;
};

/// May the simulation go on?
class Gate {
 public:
  void pause() { set(true, 0); }
  void resume() { set(false, 0); }
  /// Lets one step through and stays closed.
  void step() { set(true, 1); }

  bool is_paused() {
    const std::scoped_lock lock(mutex_);
    return paused_;
  }

  void wait(const std::function<bool()>& stop) {
    std::unique_lock lock(mutex_);
    while (paused_ && steps_ == 0) {
      if (stop()) return;
      changed_.wait_for(lock, milliseconds(100));
    }
    if (steps_ > 0) --steps_;
  }

 private:
  void set(bool paused, int steps) {
    {
      const std::scoped_lock lock(mutex_);
      paused_ = paused;
      steps_ += steps;
    }
    changed_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  bool paused_ = false;
  int steps_ = 0;
};

std::vector<std::uint8_t> scene_of(const World& world, const std::string& title,
                                   const std::string& generator) {
  RunView run = describe(world);
  run.title = title;
  run.generator = generator;
  ContainerWriter container;
  std::vector<std::string> notes;
  nlohmann::json header = write_run_header(run, container, notes);
  header["live"] = true;
  header["notes"] = notes;
  return container.finish(std::move(header));
}

}  // namespace

struct LiveServer::State {
  httplib::Server server;
  std::thread thread;
  int port = 0;
  std::string page;
  std::vector<std::uint8_t> scene;
  LiveFrames frames;
  Gate gate;
  std::atomic<int> viewers{0};
  std::atomic<bool> has_been_seen{false};
  std::atomic<bool> stopping{false};

  double frame_time = 0.0;  // simulated time between frames [s]
  double next_frame = 0.0;
  Budget budget{0.0};
  std::vector<model::StepReport> steps;  // since the last frame

  bool is_own(const httplib::Request& request) const;
  void route();
  void send_events(std::uint64_t first, httplib::Response& response);
};

/// Refuses what another site's page asks for, also when its name has been made to lead here.
bool LiveServer::State::is_own(const httplib::Request& request) const {
  const auto names_us = [this](const std::string& host) {
    return host == fmt::format("127.0.0.1:{}", port) || host == fmt::format("localhost:{}", port);
  };
  if (!names_us(request.get_header_value("Host"))) return false;
  if (request.has_header("Origin")) {
    const std::string origin = request.get_header_value("Origin");
    if (!origin.starts_with("http://") || !names_us(origin.substr(7))) return false;
  }
  const std::string site = request.get_header_value("Sec-Fetch-Site");
  return site.empty() || site == "same-origin" || site == "none";
}

void LiveServer::State::route() {
  server.set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& out) {
    if (is_own(request)) return httplib::Server::HandlerResponse::Unhandled;
    out.status = 403;
    out.set_content("This simulation is shown to its own page only.\n", "text/plain");
    return httplib::Server::HandlerResponse::Handled;
  });
  server.set_default_headers(
      {{"Cache-Control", "no-store"}, {"X-Content-Type-Options", "nosniff"}});
  server.Get("/", [this](const httplib::Request&, httplib::Response& out) {
    // From a provider, since the library would compress a text at its highest level: 1.4 s.
    out.set_content_provider(page.size(), "text/html; charset=utf-8",
                             [this](std::size_t at, std::size_t size, httplib::DataSink& sink) {
                               return sink.write(page.data() + at, size);
                             });
  });
  server.Get("/scene", [this](const httplib::Request&, httplib::Response& out) {
    out.set_content(reinterpret_cast<const char*>(scene.data()), scene.size(),
                    "application/octet-stream");
  });
  server.Get("/events", [this](const httplib::Request& request, httplib::Response& out) {
    std::uint64_t first = 0;
    const std::string from = request.get_param_value("from");
    std::from_chars(from.data(), from.data() + from.size(), first);
    send_events(first, out);
  });
  const auto command = [this](const char* path, void (Gate::*action)()) {
    server.Post(path, [this, action](const httplib::Request&, httplib::Response& out) {
      (gate.*action)();
      out.status = 204;
    });
  };
  command("/pause", &Gate::pause);
  command("/resume", &Gate::resume);
  command("/step", &Gate::step);
}

/// Server-sent events: one "frame" each, and "end". `first` is the number of the first frame: a
/// page that has lost its connection goes on where it was.
void LiveServer::State::send_events(std::uint64_t first, httplib::Response& response) {
  ++viewers;
  has_been_seen = true;
  response.set_chunked_content_provider(
      "text/event-stream",
      [this, number = first, pace = Pace()](std::size_t, httplib::DataSink& sink) mutable {
        if (stopping) return false;
        bool closed = false;
        if (!frames.is_closed()) pace.wait();
        const auto next = frames.next(number, milliseconds(500), closed);
        std::string text;
        if (next) {
          number = next->number + 1;
          pace.sent(next->frame->frame.time);
          text =
              fmt::format("id: {}\nevent: frame\ndata: {}\n\n", next->number, encode(*next->frame));
        } else {
          // A comment shows whether the viewer is still there.
          text = closed ? "event: end\ndata: end\n\n" : ": waiting\n\n";
        }
        const bool sent = sink.write(text.data(), text.size());
        if (sent && closed && !next) sink.done();
        return sent;
      },
      [this](bool) { --viewers; });
}

LiveServer::LiveServer(const World& world, const std::string& title, const std::string& generator,
                       const Options& options)
    : state_(std::make_unique<State>()) {
  State& state = *state_;
  state.page = live_page();
  state.scene = scene_of(world, title, generator);
  state.frame_time = 1.0 / options.fps;
  state.budget = Budget(options.free_seconds);
  state.next_frame = world.time() + state.frame_time;
  state.frames.push({capture(world), {}});
  state.route();
  // Whole frames at once: waiting for more to send would only delay them.
  state.server.set_tcp_nodelay(true);
  // Pages that draw slowly fall behind; their frames are kept.
  state.server.set_write_timeout(60);
  // By default the library shares a port with other programs.
  state.server.set_socket_options([](socket_t socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  });
  state.server.set_keep_alive_timeout(1);  // [s]; the end of the run waits for it
  if (options.port == 0)
    state.port = state.server.bind_to_any_port("127.0.0.1");
  else if (state.server.bind_to_port("127.0.0.1", options.port))
    state.port = options.port;
  if (state.port <= 0)
    throw Error(options.port == 0
                    ? "the live view found no free port on this machine"
                    : fmt::format("the live view cannot use port {}: it is taken", options.port));
  state.thread = std::thread([&state] { state.server.listen_after_bind(); });
  while (!state.server.is_running()) std::this_thread::sleep_for(milliseconds(1));
}

LiveServer::~LiveServer() { finish(0.0); }

int LiveServer::port() const { return state_->port; }
std::string LiveServer::address() const { return fmt::format("http://127.0.0.1:{}/", port()); }

void LiveServer::on_step(const World& world, const model::StepReport& report) {
  State& state = *state_;
  state.steps.push_back(report);
  state.budget.earn(report.total_s());
  // Single steps are all shown.
  const bool due = world.time() >= state.next_frame - 1e-9 && state.budget.is_enough();
  if (!due && !state.gate.is_paused()) return;
  const Stopwatch watch;
  if (world.time() >= state.next_frame - 1e-9) state.next_frame += state.frame_time;
  // Steps longer than a frame's time: the next frame is the next step.
  state.next_frame = std::max(state.next_frame, world.time());
  state.frames.push({capture(world), curve_points(state.steps, kCurvePointsPerFrame)});
  state.steps.clear();
  state.budget.spend(watch.seconds());
}

bool LiveServer::wait_for_viewer(double seconds, const std::function<bool()>& stop) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!state_->has_been_seen && !stop() && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(milliseconds(20));
  return state_->has_been_seen;
}

void LiveServer::wait_while_paused(const std::function<bool()>& stop) { state_->gate.wait(stop); }

void LiveServer::finish(double seconds) {
  State& state = *state_;
  if (!state.thread.joinable()) return;
  state.frames.close();
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (state.viewers > 0 && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(milliseconds(10));
  state.stopping = true;
  state.server.stop();
  state.thread.join();
}

}  // namespace gotai::view
