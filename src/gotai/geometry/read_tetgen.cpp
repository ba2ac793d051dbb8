// TetGen .node and .ele (TetGen manual, "File formats").
#include <fmt/format.h>

#include "gotai/core/error.h"
#include "gotai/geometry/import.h"
#include "gotai/geometry/text_reader.h"

namespace gotai::geometry::detail {

namespace {

/// @returns the number of the first node, 0 or 1
std::int64_t read_nodes(const Source& source, Import& out) {
  TextReader text(source.path, source.bytes, '#');
  const std::size_t count = text.count("the number of nodes", 8);
  if (const std::int64_t d = text.integer("the dimension"); d != 3)
    text.fail(fmt::format("dimension {}; only meshes in space can be bodies", d));
  text.rest_of_line();
  std::int64_t first = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t number = text.integer("a node number");
    if (i == 0) first = number;
    if (first < 0 || first > 1 || number != first + static_cast<std::int64_t>(i))
      text.fail(fmt::format("node number {}; nodes must be numbered in order from 0 or 1", number));
    Vec3 v;
    for (double& x : v) x = text.real("a coordinate");
    out.vertices.push_back(v);
    out.vertex_lines.push_back(text.line());
    text.rest_of_line();  // attributes and boundary marker
  }
  return first;
}

void read_elements(const Source& source, std::int64_t first, Import& out) {
  TextReader text(source.path, source.bytes, '#');
  const std::size_t count = text.count("the number of tetrahedra", 10);
  const std::int64_t corners = text.integer("the number of nodes of a tetrahedron");
  if (corners != 4 && corners != 10)
    text.fail(fmt::format("{} nodes in a tetrahedron; must be 4 or 10", corners));
  text.rest_of_line();
  for (std::size_t i = 0; i < count; ++i) {
    text.integer("the number of a tetrahedron");
    Tetrahedron tet;
    for (std::uint32_t& v : tet) {
      const std::int64_t number = text.integer("a node number");
      if (number < first || number >= first + static_cast<std::int64_t>(out.vertices.size()))
        text.fail(fmt::format("node {} is not in the .node file", number));
      v = static_cast<std::uint32_t>(number - first);
    }
    out.tetrahedra.push_back(tet);
    out.tetrahedron_lines.push_back(text.line());
    text.rest_of_line();  // further nodes and attributes
  }
}

}  // namespace

Import read_tetgen(const Source& nodes, const Source& elements) {
  Import out;
  out.format = "TetGen";
  read_elements(elements, read_nodes(nodes, out), out);
  return out;
}

}  // namespace gotai::geometry::detail
