/// @file
/// Ctrl-C, a polite kill and a lost terminal: the run ends after the step it is in.
#pragma once

namespace gotai::cli {

/// While it lives, the first SIGINT, SIGTERM or SIGHUP is only remembered; a second one ends the
/// program at once. One object at a time.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  /// Has one of the signals come?
  bool is_interrupted() const;
};

}  // namespace gotai::cli
