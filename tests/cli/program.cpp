#include "program.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace gotai::test {
std::string read_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::string write_text(const TemporaryFolder& folder, const std::string& name,
                       const std::string& text) {
  std::ofstream(folder.file(name), std::ios::binary) << text;
  return folder.file(name);
}

Program::Program(const std::vector<std::string>& arguments) {
  std::vector<std::string> words = {GOTAI_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  const int flags = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, folder_.file("out").c_str(), flags, 0600);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, folder_.file("err").c_str(), flags, 0600);
  const int error = posix_spawn(&pid_, GOTAI_PROGRAM, &files, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (error != 0) throw std::runtime_error("cannot start " GOTAI_PROGRAM);
}

Program::~Program() {
  if (is_running()) {
    send_signal(SIGKILL);
    waitpid(pid_, &status_, 0);
  }
}

void Program::send_signal(int signal) const { kill(pid_, signal); }

bool Program::is_running() {
  if (!finished_) finished_ = waitpid(pid_, &status_, WNOHANG) == pid_;
  return !finished_;
}

Outcome Program::finish() {
  if (!finished_) {
    waitpid(pid_, &status_, 0);
    finished_ = true;
  }
  Outcome outcome;
  outcome.exit_code = WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_);
  outcome.out = read_file(folder_.file("out"));
  outcome.err = read_file(folder_.file("err"));
  return outcome;
}

Outcome run_gotai(const std::vector<std::string>& arguments) { return Program(arguments).finish(); }

}  // namespace gotai::test
