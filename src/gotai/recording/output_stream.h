/// @file
/// Files that appear whole or not at all. Internal to the module.
#pragma once

#include <fstream>
#include <string>

namespace gotai::recording {

/// Writes beside the target and renames at the end. Without commit() nothing stays.
class OutputStream {
 public:
  /// @throws FileError when it cannot be opened
  explicit OutputStream(const std::string& path);
  ~OutputStream();
  OutputStream(const OutputStream&) = delete;
  OutputStream& operator=(const OutputStream&) = delete;

  std::ofstream& stream() { return stream_; }
  /// @throws FileError when something could not be written (a full disk)
  void commit();

 private:
  std::string path_;
  std::string partial_;
  std::ofstream stream_;
};

}  // namespace gotai::recording
