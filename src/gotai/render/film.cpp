#include "gotai/render/film.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <vector>

#include "gotai/core/error.h"

namespace gotai::render {
namespace {

/// Starts a program with its standard input from a pipe; returns the process.
pid_t spawn(std::vector<std::string> arguments, int input) {
  std::vector<char*> argv;
  argv.reserve(arguments.size() + 1);
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
  pid_t process = -1;
  const int failed = posix_spawnp(&process, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  return failed == 0 ? process : -1;
}

}  // namespace

bool have_ffmpeg() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (access((std::filesystem::path(folder) / "ffmpeg").c_str(), X_OK) == 0) return true;
  return false;
}

Film::Film(std::string path, int width, int height, double fps) : path_(std::move(path)) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw Error("no pipe to ffmpeg can be opened");
  // Players want an even number of pixels and colours at half resolution.
  process_ = spawn({"ffmpeg",    "-y",
                    "-loglevel", "error",
                    "-f",        "rawvideo",
                    "-pix_fmt",  "rgb24",
                    "-s",        fmt::format("{}x{}", width, height),
                    "-r",        fmt::format("{:g}", fps),
                    "-i",        "-",
                    "-vf",       "pad=ceil(iw/2)*2:ceil(ih/2)*2",
                    "-c:v",      "libx264",
                    "-crf",      "18",
                    "-pix_fmt",  "yuv420p",
                    "-movflags", "+faststart",
                    "-f",        "mp4",
                    path_},
                   ends[0]);
  close(ends[0]);
  pipe_ = ends[1];
  if (process_ < 0) {
    close(pipe_);
    throw Error("ffmpeg cannot be started; is it installed?");
  }
}

Film::~Film() {
  if (pipe_ >= 0) close(pipe_);
  if (process_ > 0) waitpid(process_, nullptr, 0);
}

void Film::add(const Picture& picture) {
  // A dead ffmpeg is reported as an error here, not as a signal that ends the program.
  struct sigaction ignore {};
  struct sigaction before {};
  ignore.sa_handler = SIG_IGN;
  sigaction(SIGPIPE, &ignore, &before);
  std::size_t written = 0;
  bool broken = false;
  while (written < picture.rgb.size() && !broken) {
    const ssize_t count = write(pipe_, picture.rgb.data() + written, picture.rgb.size() - written);
    if (count > 0)
      written += static_cast<std::size_t>(count);
    else
      broken = errno != EINTR;
  }
  sigaction(SIGPIPE, &before, nullptr);
  if (broken) throw FileError(path_, "ffmpeg stopped before the film was complete");
}

void Film::finish() {
  close(pipe_);
  pipe_ = -1;
  int status = 0;
  waitpid(process_, &status, 0);
  process_ = -1;
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw FileError(path_, "ffmpeg could not write the film; its message is above");
}

}  // namespace gotai::render
