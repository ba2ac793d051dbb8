/// @file
/// Films, made by the program ffmpeg.
#pragma once

#include <string>

#include "gotai/render/picture.h"

namespace gotai::render {

/// Is ffmpeg installed?
bool have_ffmpeg();

/// Hands pictures to ffmpeg, which writes an H.264 film (MP4) that plays everywhere.
class Film {
 public:
  /// @param fps  pictures per second
  /// @throws Error when ffmpeg cannot be started
  Film(std::string path, int width, int height, double fps);
  ~Film();
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;

  /// @throws FileError when ffmpeg has stopped
  void add(const Picture& picture);
  /// Waits until the film is complete.
  /// @throws FileError when ffmpeg failed
  void finish();

 private:
  std::string path_;
  int pipe_ = -1;
  int process_ = -1;
};

}  // namespace gotai::render
