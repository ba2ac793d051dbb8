#include "gotai/geometry/import.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "gotai/core/error.h"
#include "gotai/geometry/text_reader.h"

namespace gotai::geometry::detail {

std::string read_bytes(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw FileError(path.string(), "is a folder; name a mesh file");
  std::ifstream in(path, std::ios::binary);
  if (!in)
    throw FileError(path.string(), fmt::format("cannot be opened: {}", std::strerror(errno)));
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  std::string bytes(error ? 0 : size, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (error || static_cast<std::uintmax_t>(in.gcount()) != size)
    throw FileError(path.string(), "cannot be read to its end");
  return bytes;
}

namespace {

std::string_view skip_space(std::string_view bytes) {
  const std::size_t begin = bytes.find_first_not_of(" \t\r\n");
  return begin == std::string_view::npos ? std::string_view() : bytes.substr(begin);
}

}  // namespace

Import import(const Source& source) {
  const std::string_view start = skip_space(source.bytes.substr(0, 4096));
  const std::string extension = lower(source.path.extension().string());
  if (start.empty()) throw FileError(source.path.string(), "is empty");
  if (start.starts_with("$")) return read_gmsh(source);
  if (extension == ".stl" || lower(start.substr(0, 6)) == "solid ") return read_stl(source);
  return read_obj(source);
}

}  // namespace gotai::geometry::detail
