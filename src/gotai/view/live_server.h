/// @file
/// Shows a world in a browser while it steps: a small server for this machine only.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "gotai/model/step.h"
#include "gotai/world/world.h"

namespace gotai::view {

/// Serves the viewer's page and the frames of a running world on 127.0.0.1. Browsers of other
/// machines cannot reach it, and pages from elsewhere are refused: every request must name this
/// server as its host, and, where the browser says so, come from this server's own page.
///
/// The simulation hands over copies of its state; packing and sending happen on the server's
/// threads, so that a step waits for nobody.
class LiveServer {
 public:
  struct Options {
    int port = 0;       ///< 0: any free one
    double fps = 60.0;  ///< frames per second of simulated time; fewer where they would cost more
                        ///< than a fortieth of the run's time
    double free_seconds = 0.05;  ///< that frames may cost in the whole run beyond that [s]
  };

  /// Starts serving the world as it is.
  /// @throws Error when the port cannot be bound or the program was built without the viewer
  LiveServer(const World& world, const std::string& title, const std::string& generator,
             const Options& options);
  /// Ends without waiting for anybody.
  ~LiveServer();
  LiveServer(const LiveServer&) = delete;
  LiveServer& operator=(const LiveServer&) = delete;

  int port() const;
  /// "http://127.0.0.1:PORT/"
  std::string address() const;

  /// Waits (at most so many seconds, or until `stop` says so) for the first page to be there.
  /// @returns whether one is
  bool wait_for_viewer(double seconds, const std::function<bool()>& stop);
  /// Call after every step.
  void on_step(const World& world, const model::StepReport& report);
  /// Returns at once while the simulation may go on; while a viewer has paused it, returns when it
  /// resumes, asks for a single step, or `stop` says so (asked ten times a second).
  void wait_while_paused(const std::function<bool()>& stop);
  /// Lets viewers fetch what they have not got yet (at most so many seconds), tells them that the
  /// run has ended, and stops serving.
  void finish(double seconds);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gotai::view
