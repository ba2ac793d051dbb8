// STL, ascii and binary. Facet normals are ignored: the order of the vertices says the same.
#include <fmt/format.h>

#include "gotai/geometry/import.h"
#include "gotai/geometry/text_reader.h"

namespace gotai::geometry::detail {

namespace {

constexpr std::size_t kHeader = 84;
constexpr std::size_t kFacet = 50;

/// Many binary files start with "solid" too, so the size decides.
bool is_ascii(std::string_view bytes) {
  if (lower(bytes.substr(0, 5)) != "solid") return false;
  if (bytes.size() >= kHeader) {
    BinaryReader header("", bytes, 80);
    if (bytes.size() == kHeader + kFacet * std::size_t{header.read<std::uint32_t>()}) return false;
  }
  return bytes.substr(0, 1024).find('\0') == std::string_view::npos;
}

Import read_binary(const Source& source) {
  Import out;
  out.format = "STL (binary)";
  BinaryReader in(source.path, source.bytes);
  in.skip(80);
  const std::size_t facets = in.read<std::uint32_t>();
  in.require_room(facets, kFacet, "the number of facets");
  out.vertices.reserve(facets * 3);
  for (std::uint32_t f = 0; f < facets; ++f) {
    in.skip(12);
    for (std::uint32_t k = 0; k < 3; ++k) {
      Vec3 v;
      for (double& x : v) x = static_cast<double>(in.read<float>());
      out.vertices.push_back(v);
      out.corners.push_back(3 * f + k);
    }
    in.skip(2);
    out.end_polygon();
  }
  if (in.remaining() > 0)
    out.notes.push_back(fmt::format("{} bytes after the last facet are ignored", in.remaining()));
  return out;
}

Import read_ascii(const Source& source) {
  Import out;
  out.format = "STL (ascii)";
  TextReader text(source.path, source.bytes);
  while (!text.at_end()) {
    const std::string keyword = lower(text.word());
    if (keyword == "solid" || keyword == "endsolid") {
      text.rest_of_line();
    } else if (keyword == "facet") {
      out.polygon_lines.push_back(text.line());
      text.rest_of_line();  // the normal
    } else if (keyword == "vertex") {
      out.vertex_lines.push_back(text.line());
      Vec3 v;
      for (double& x : v) x = text.real("a coordinate");
      out.corners.push_back(static_cast<std::uint32_t>(out.vertices.size()));
      out.vertices.push_back(v);
    } else if (keyword == "endfacet") {
      if (out.corners.size() - out.first.back() < 3 ||
          out.polygon_lines.size() != out.polygon_count() + 1)
        text.fail("a facet needs 'facet normal', then three vertices");
      out.end_polygon();
    } else if (keyword != "outer" && keyword != "loop" && keyword != "endloop") {
      text.fail(fmt::format("'{}' is no keyword of an ascii STL file", keyword.substr(0, 40)));
    }
  }
  if (out.corners.size() != out.first.back()) text.fail("the file ends within a facet");
  return out;
}

}  // namespace

Import read_stl(const Source& source) {
  return is_ascii(source.bytes) ? read_ascii(source) : read_binary(source);
}

}  // namespace gotai::geometry::detail
