#include "gotai/voxel/shape_cache.h"

#include <cstdlib>
#include <optional>
#include <system_error>
#include <utility>

#include "gotai/core/error.h"
#include "gotai/voxel/shape_file.h"

namespace gotai::voxel {
namespace {

/// An entry that is there, whole and of this content.
std::optional<Shape> read_entry(const std::filesystem::path& entry, const Hash128& content,
                                std::string& warning) {
  std::error_code error;
  if (!std::filesystem::exists(entry, error)) return std::nullopt;
  try {
    Shape shape = read_shape(entry);
    if (shape.content == content) return shape;
    warning = entry.string() + ": holds another shape; it was replaced";
  } catch (const FileError& unreadable) {
    warning = std::string(unreadable.what()) + "; it was replaced";
  }
  return std::nullopt;
}

}  // namespace

std::filesystem::path default_cache_folder() {
  if (const char* folder = std::getenv("GOTAI_CACHE")) return folder;
  if (const char* folder = std::getenv("XDG_CACHE_HOME"); folder != nullptr && *folder != '\0')
    return std::filesystem::path(folder) / "gotai";
  if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0')
    return std::filesystem::path(home) / ".cache" / "gotai";
  return {};
}

std::filesystem::path cache_entry(const std::filesystem::path& folder, const Hash128& content) {
  return folder / (content.hex() + kShapeFileExtension);
}

CachedShape make_shape_cached(std::string name, geometry::Mesh mesh, const ShapeOptions& options,
                              const std::filesystem::path& folder) {
  CachedShape result;
  if (folder.empty()) {
    result.shape = make_shape(std::move(name), std::move(mesh), options);
    return result;
  }
  const Hash128 content = content_hash(mesh, options);
  const std::filesystem::path entry = cache_entry(folder, content);
  if (std::optional<Shape> shape = read_entry(entry, content, result.warning)) {
    result.shape = std::move(*shape);
    result.shape.name = std::move(name);
    result.hit = true;
    return result;
  }
  result.shape = make_shape(std::move(name), std::move(mesh), options);
  try {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    write_shape(entry, result.shape);
  } catch (const FileError& unwritable) {
    result.warning = unwritable.what();
  }
  return result;
}

}  // namespace gotai::voxel
