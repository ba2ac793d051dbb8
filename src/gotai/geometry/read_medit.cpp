// MEDIT .mesh, ascii (Frey 2001, "Medit: an interactive mesh visualization software").
#include <fmt/format.h>

#include <limits>

#include "gotai/geometry/import.h"
#include "gotai/geometry/text_reader.h"

namespace gotai::geometry::detail {

namespace {

std::uint32_t read_index(TextReader& text) {
  const std::int64_t index = text.integer("a vertex index");
  if (index < 1 || index > std::numeric_limits<std::uint32_t>::max())
    text.fail(fmt::format("vertex index {}; MEDIT counts from 1", index));
  return static_cast<std::uint32_t>(index - 1);
}

void read_vertices(TextReader& text, Import& out) {
  const std::size_t count = text.count("the number of vertices", 8);
  for (std::size_t i = 0; i < count; ++i) {
    Vec3 v;
    for (double& x : v) x = text.real("a coordinate");
    out.vertex_lines.push_back(text.line());
    text.required("a reference");
    out.vertices.push_back(v);
  }
}

void read_faces(TextReader& text, std::size_t corners, Import& out) {
  const std::size_t count = text.count("the number of faces", 2 * corners);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < corners; ++k) out.corners.push_back(read_index(text));
    out.polygon_lines.push_back(text.line());
    text.required("a reference");
    out.end_polygon();
  }
}

void read_tetrahedra(TextReader& text, Import& out) {
  const std::size_t count = text.count("the number of tetrahedra", 10);
  for (std::size_t i = 0; i < count; ++i) {
    Tetrahedron tet;
    for (std::uint32_t& v : tet) v = read_index(text);
    out.tetrahedron_lines.push_back(text.line());
    text.required("a reference");
    out.tetrahedra.push_back(tet);
  }
}

bool is_keyword(std::string_view word) {
  return (word.front() >= 'A' && word.front() <= 'Z') ||
         (word.front() >= 'a' && word.front() <= 'z');
}

}  // namespace

Import read_medit(const Source& source) {
  Import out;
  out.format = "MEDIT";
  TextReader text(source.path, source.bytes, '#');
  while (!text.at_end()) {
    const std::string keyword(text.word());
    if (keyword == "Dimension") {
      if (const std::int64_t d = text.integer("the dimension"); d != 3)
        text.fail(fmt::format("dimension {}; only meshes in space can be bodies", d));
    } else if (keyword == "Vertices") {
      read_vertices(text, out);
    } else if (keyword == "Triangles") {
      read_faces(text, 3, out);
    } else if (keyword == "Quadrilaterals") {
      read_faces(text, 4, out);
    } else if (keyword == "Tetrahedra") {
      read_tetrahedra(text, out);
    } else if (keyword == "End") {
      break;
    } else {
      if (!is_keyword(keyword))
        text.fail("a keyword should be here; the count before may be wrong");
      if (keyword == "Hexahedra" || keyword == "Prisms" || keyword == "Pyramids")
        out.notes.push_back(keyword + " were ignored; mesh the solid with tetrahedra to keep them");
      while (!text.at_end() && !is_keyword(text.peek())) text.word();
    }
  }
  return out;
}

}  // namespace gotai::geometry::detail
