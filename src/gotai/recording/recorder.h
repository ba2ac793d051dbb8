/// @file
/// Records a running world into an HDF5 file (docs/recording.md lists the datasets).
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "gotai/core/stopwatch.h"
#include "gotai/model/step.h"
#include "gotai/world/world.h"

namespace gotai::recording {

/// What is recorded, and how often.
struct RecorderOptions {
  double fps = 60.0;         ///< frames per second of simulated time
  bool contacts = true;      ///< contacts of every frame
  double flush = 1.0;        ///< seconds of wall time between flushes
  double checkpoint = 30.0;  ///< seconds of wall time between checkpoints; 0: only the last one
};

/// What made the world: stored as it is, so that the run can be repeated and resumed.
struct SceneSource {
  std::string path;
  std::string text;
  std::vector<std::string> overrides;  ///< "--set" assignments
};

/// Writes frames, contacts, per-step figures and checkpoints. A frame is recorded at the first step
/// at or after each frame time, with its true time; recording never changes the simulation.
/// Everything up to the last flush survives a killed process and a full disk.
class Recorder {
 public:
  /// Starts a recording with the world as it is as its first frame.
  /// @throws FileError when the file exists or cannot be written
  Recorder(const std::string& path, const World& world, const SceneSource& scene,
           const RecorderOptions& options = {});

  /// Goes on with a recording from its last checkpoint: sets the world to that state and drops what
  /// was recorded after it (it will be computed again, bit for bit).
  /// @param world  built from the same scene
  /// @throws FileError when there is no checkpoint, or the world has other bodies or shapes
  static Recorder resume(const std::string& path, World& world, const RecorderOptions& options);

  ~Recorder();
  Recorder(Recorder&&) noexcept;
  Recorder& operator=(Recorder&&) = delete;

  /// Call after every step, or add it as an observer of the world.
  /// @throws FileError when the disk is full; what was flushed stays readable
  void on_step(const World& world, const model::StepReport& report);
  /// Writes what is pending and a checkpoint of the world as it is.
  void checkpoint(const World& world);
  /// Writes what is pending.
  void flush();
  /// Ends the recording: a last checkpoint, and the certificate.
  /// @param certificate  JSON text of the run's summary
  void finish(const World& world, const std::string& certificate);

  std::uint64_t frame_count() const;
  const std::string& path() const;

 private:
  struct State;
  explicit Recorder(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace gotai::recording
