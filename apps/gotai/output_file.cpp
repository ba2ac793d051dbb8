#include "output_file.h"

#include <filesystem>

#include "gotai/core/error.h"

namespace gotai::cli {

void require_free(const std::string& path, bool force) {
  const std::filesystem::path file(path);
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  if (!std::filesystem::is_directory(folder)) {
    throw FileError(path, "its folder does not exist; make it first");
  }
  if (std::filesystem::is_directory(file)) throw FileError(path, "is a folder; name a file");
  if (!force && std::filesystem::exists(file)) {
    throw FileError(path, "exists already; choose another name or overwrite it with --force");
  }
}

}  // namespace gotai::cli
