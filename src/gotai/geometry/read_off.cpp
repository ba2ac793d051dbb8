// Geomview OFF (ascii) with its prefixes for colours, normals and texture coordinates.
#include <fmt/format.h>

#include <limits>

#include "gotai/geometry/import.h"
#include "gotai/geometry/text_reader.h"

namespace gotai::geometry::detail {

Import read_off(const Source& source) {
  Import out;
  out.format = "OFF";
  TextReader text(source.path, source.bytes, '#');
  if (text.peek().ends_with("OFF")) {
    const std::string_view header = text.word();
    if (header.find_first_of("4n") != std::string_view::npos)
      text.fail("points in more than three dimensions");
    if (text.peek() == "BINARY")
      text.fail("binary OFF is not read; save it as ascii OFF or as PLY");
  }
  const std::size_t vertices = text.count("the number of vertices", 6);
  const std::size_t faces = text.count("the number of faces", 4);
  text.rest_of_line();  // the number of edges, often missing
  out.vertices.reserve(vertices);
  for (std::size_t i = 0; i < vertices; ++i) {
    Vec3 v;
    for (double& x : v) x = text.real("a coordinate");
    out.vertices.push_back(v);
    out.vertex_lines.push_back(text.line());
    text.rest_of_line();  // normals, colours, texture coordinates
  }
  for (std::size_t i = 0; i < faces; ++i) {
    const std::size_t corners = text.count("the number of corners", 2);
    for (std::size_t k = 0; k < corners; ++k) {
      const std::int64_t index = text.integer("a vertex index");
      if (index < 0 || index >= std::numeric_limits<std::uint32_t>::max())
        text.fail(fmt::format("vertex index {} is impossible", index));
      out.corners.push_back(static_cast<std::uint32_t>(index));
    }
    const std::size_t line = text.line();
    text.rest_of_line();  // colours
    if (corners < 3) {    // points and lines
      out.corners.resize(out.first.back());
      continue;
    }
    out.end_polygon();
    out.polygon_lines.push_back(line);
  }
  return out;
}

}  // namespace gotai::geometry::detail
