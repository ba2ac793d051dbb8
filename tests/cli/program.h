/// @file
/// Runs the built program as a user would.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/temporary_folder.h"

namespace gotai::test {

/// What a finished program left behind.
struct Outcome {
  int exit_code = 0;  ///< 128 + signal when a signal ended it
  std::string out;    ///< standard output
  std::string err;    ///< standard error

  /// Standard output as JSON.
  nlohmann::json json() const { return nlohmann::json::parse(out); }
};

/// Writes a text file into a folder and returns its path.
std::string write_text(const TemporaryFolder& folder, const std::string& name,
                       const std::string& text);

/// The bytes of a file.
std::string read_file(const std::filesystem::path& path);

/// `gotai` with these arguments, running in the background; its output goes to files.
class Program {
 public:
  explicit Program(const std::vector<std::string>& arguments);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void send_signal(int signal) const;
  bool is_running();
  /// Waits for the end.
  Outcome finish();

 private:
  TemporaryFolder folder_;
  pid_t pid_ = -1;
  int status_ = 0;
  bool finished_ = false;
};

/// Runs `gotai` with these arguments to the end.
Outcome run_gotai(const std::vector<std::string>& arguments);

}  // namespace gotai::test
