#include "gotai/recording/output_stream.h"

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "gotai/core/error.h"

namespace gotai::recording {

OutputStream::OutputStream(const std::string& path)
    : path_(path), partial_(path + ".part"), stream_(partial_, std::ios::binary) {
  if (!stream_) throw FileError(path, std::string("cannot be written: ") + std::strerror(errno));
}

OutputStream::~OutputStream() {
  stream_.close();
  std::error_code error;
  std::filesystem::remove(partial_, error);
}

void OutputStream::commit() {
  errno = 0;
  stream_.close();
  if (!stream_) throw FileError(path_, std::string("cannot be written: ") + std::strerror(errno));
  std::error_code error;
  std::filesystem::rename(partial_, path_, error);
  if (error) throw FileError(path_, "cannot be written: " + error.message());
}

}  // namespace gotai::recording
