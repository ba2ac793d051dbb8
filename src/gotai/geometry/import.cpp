#include "gotai/geometry/import.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <new>
#include <utility>

#include "gotai/core/error.h"
#include "gotai/geometry/text_reader.h"

namespace gotai::geometry::detail {

std::string read_bytes(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  // A folder cannot be read, a pipe or a device may never end.
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    throw FileError(path.string(), std::filesystem::is_directory(status)
                                       ? "is a folder; name a mesh file"
                                       : "is no ordinary file");
  std::ifstream in(path, std::ios::binary);
  if (!in)
    throw FileError(path.string(), fmt::format("cannot be opened: {}", std::strerror(errno)));
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  try {
    std::string bytes(error ? 0 : size, '\0');
    in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (error || static_cast<std::uintmax_t>(in.gcount()) != size)
      throw FileError(path.string(), "cannot be read to its end");
    return bytes;
  } catch (const std::bad_alloc&) {
    throw FileError(path.string(), fmt::format("has {} bytes, more than fit into memory", size));
  }
}

namespace {

/// How a file begins, and who reads it or why nobody does.
struct Signature {
  std::string_view start;
  Import (*read)(const Source&);
  std::string_view refusal;
};

constexpr std::string_view kXmlRefusal =
    "is XML; of such files none is read. Save VTK data in the legacy format (.vtk), COLLADA and "
    "others as glTF, OBJ or PLY";

constexpr Signature kSignatures[] = {
    {"ply\n", read_ply, ""},
    {"ply\r", read_ply, ""},
    {"glTF", read_gltf, ""},
    {"{", read_gltf, ""},
    {"OFF", read_off, ""},
    {"COFF", read_off, ""},
    {"NOFF", read_off, ""},
    {"CNOFF", read_off, ""},
    {"NCOFF", read_off, ""},
    {"STOFF", read_off, ""},
    {"4OFF", read_off, ""},
    {"nOFF", read_off, ""},
    {"# vtk DataFile", read_vtk, ""},
    {"MeshVersionFormatted", read_medit, ""},
    {"$", read_gmsh, ""},
    {"MFEM", nullptr, "is an MFEM mesh; convert it to gmsh, MEDIT or legacy VTK tetrahedra"},
    {"<", nullptr, kXmlRefusal},
    {"PK\x03\x04", nullptr, "is a zip archive (3MF?); export it as STL, OBJ or PLY"},
    {"ISO-10303-21", nullptr, "is a STEP file; mesh it first and save it as STL, OBJ or gmsh"},
    {"Kaydara FBX", nullptr, "is an FBX file; export it as glTF or OBJ"},
    {"; FBX", nullptr, "is an FBX file; export it as glTF or OBJ"},
    {"BLENDER", nullptr, "is a Blender scene; export it as glTF, OBJ or PLY"},
    {"\x89HDF", nullptr, "is an HDF5 file, not a mesh"},
    {"SQLite format", nullptr, "is a database, not a mesh"},
};

/// Formats without a signature, by extension.
constexpr std::pair<std::string_view, Import (*)(const Source&)> kExtensions[] = {
    {".obj", read_obj},
    {".stl", read_stl},
    {".off", read_off},
    {".mesh", read_medit},
};

Import read_tetgen_pair(const Source& source, const std::string& extension) {
  std::filesystem::path other = source.path;
  other.replace_extension(extension == ".node" ? ".ele" : ".node");
  std::error_code error;
  if (!std::filesystem::is_regular_file(other, error))
    throw FileError(source.path.string(),
                    fmt::format("a TetGen mesh is two files; {} is missing", other.string()));
  const std::string bytes = read_bytes(other);
  const Source second{other, bytes};
  return extension == ".node" ? read_tetgen(source, second) : read_tetgen(second, source);
}

/// Binary STL has no signature; its size says what it is.
bool has_size_of_binary_stl(std::string_view bytes) {
  if (bytes.size() < 84) return false;
  BinaryReader header({}, bytes, 80);
  return bytes.size() == 84 + 50 * std::size_t{header.read<std::uint32_t>()};
}

/// The first lines that are not comments.
std::string_view skip_comments(std::string_view bytes) {
  TextReader text({}, bytes, '#');
  text.peek();
  return bytes.substr(text.position());
}

bool looks_like_obj(std::string_view bytes) {
  TextReader text({}, bytes, '#');
  for (int line = 0; line < 1000 && !text.at_end(); ++line) {
    const std::string_view keyword = text.word_on_line();
    if (keyword == "v" || keyword == "mtllib" || keyword == "o" || keyword == "g") return true;
    text.rest_of_line();
  }
  return false;
}

const Signature* find_signature(std::string_view start) {
  for (const Signature& signature : kSignatures)
    if (start.starts_with(signature.start)) return &signature;
  return nullptr;
}

}  // namespace

Import import(const Source& source) {
  const std::string extension = lower(source.path.extension().string());
  const std::size_t begin = source.bytes.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos) throw FileError(source.path.string(), "is empty");
  if (has_size_of_binary_stl(source.bytes)) return read_stl(source);
  if (extension == ".node" || extension == ".ele") return read_tetgen_pair(source, extension);
  const Signature* signature = find_signature(source.bytes.substr(begin));
  if (signature == nullptr) signature = find_signature(skip_comments(source.bytes));
  if (signature != nullptr) {
    if (signature->read != nullptr) return signature->read(source);
    throw FileError(source.path.string(), signature->refusal);
  }
  for (const auto& [known, read] : kExtensions)
    if (extension == known) return read(source);
  if (lower(source.bytes.substr(begin, 5)) == "solid") return read_stl(source);
  if (looks_like_obj(source.bytes)) return read_obj(source);
  throw FileError(source.path.string(),
                  "is no mesh of a known format (OBJ, STL, PLY, OFF, glTF, gmsh, MEDIT, TetGen, "
                  "legacy VTK)");
}

}  // namespace gotai::geometry::detail
