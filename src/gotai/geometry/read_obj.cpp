// Wavefront OBJ: v and f; normals, texture coordinates, groups and materials are of no use here.
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "gotai/geometry/import.h"
#include "gotai/geometry/text_reader.h"

namespace gotai::geometry::detail {

namespace {

/// Next word of a statement, which goes on in the next line after a backslash.
std::string_view next_word(TextReader& text) {
  std::string_view word = text.word_on_line();
  while (word == "\\") {
    text.rest_of_line();
    word = text.word_on_line();
  }
  return word;
}

void read_vertex(TextReader& text, Import& out) {
  Vec3 v;
  for (double& x : v) x = text.to_real(next_word(text), "a coordinate");
  out.vertices.push_back(v);
  out.vertex_lines.push_back(text.line());
}

/// "7", "7/1", "7/1/2", "7//2"; negative numbers count back from the last vertex so far.
std::uint32_t corner(const TextReader& text, std::string_view word, std::size_t vertices) {
  const std::int64_t index = text.to_integer(word.substr(0, word.find('/')), "a vertex index");
  if (index == 0)
    text.fail(
        "vertex index 0; OBJ counts from 1. Re-export the file, or add 1 to "
        "every index");
  const std::int64_t zero_based =
      index > 0 ? index - 1 : static_cast<std::int64_t>(vertices) + index;
  if (zero_based < 0 || zero_based >= std::numeric_limits<std::uint32_t>::max())
    text.fail(fmt::format("vertex index {} when there are {} vertices so far", index, vertices));
  return static_cast<std::uint32_t>(zero_based);
}

void read_face(TextReader& text, Import& out) {
  const std::size_t line = text.line();
  for (std::string_view word = next_word(text); !word.empty(); word = next_word(text))
    out.corners.push_back(corner(text, word, out.vertices.size()));
  if (out.corners.size() - out.first.back() < 3) text.fail("a face needs at least three vertices");
  out.end_polygon();
  out.polygon_lines.push_back(line);
}

}  // namespace

Import read_obj(const Source& source) {
  Import out;
  out.format = "OBJ";
  TextReader text(source.path, source.bytes, '#');
  while (!text.at_end()) {
    const std::string_view keyword = text.word_on_line();
    if (keyword == "v") {
      read_vertex(text, out);
    } else if (keyword == "f" || keyword == "fo") {
      read_face(text, out);
    }
    text.rest_of_line();
  }
  return out;
}

}  // namespace gotai::geometry::detail
