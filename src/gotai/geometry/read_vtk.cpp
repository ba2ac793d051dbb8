// Legacy VTK, ascii and binary: UNSTRUCTURED_GRID and POLYDATA (VTK file formats, chapter
// "Simple legacy formats"; version 5 writes cells as OFFSETS and CONNECTIVITY).
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "gotai/geometry/import.h"
#include "gotai/geometry/text_reader.h"

namespace gotai::geometry::detail {

namespace {

/// Cells one after the other: cell i has corners[first[i]] .. corners[first[i + 1] - 1].
struct Cells {
  std::vector<std::uint32_t> corners;
  std::vector<std::size_t> first = {0};
  std::size_t count() const { return first.size() - 1; }
};

std::size_t bytes_of(std::string_view type) {
  if (type == "char" || type == "unsigned_char") return 1;
  if (type == "short" || type == "unsigned_short") return 2;
  if (type == "int" || type == "unsigned_int" || type == "float") return 4;
  if (type == "long" || type == "unsigned_long" || type == "double" || type == "vtktypeint64" ||
      type == "vtkIdType")
    return 8;
  return 0;
}

class VtkReader {
 public:
  explicit VtkReader(const Source& source) : source_(source), text_(source.path, source.bytes) {}

  Import read() {
    read_head();
    while (!text_.at_end()) {
      const std::string keyword(text_.word());
      // Attributes come last and are of no use here.
      if (keyword == "POINT_DATA" || keyword == "CELL_DATA") break;
      read_section(keyword);
    }
    if (is_grid_) add_grid_cells();
    if (other_volumes_ > 0)
      out_.notes.push_back(
          fmt::format("{} volume cells are no tetrahedra and were ignored; mesh "
                      "the solid with tetrahedra to keep them",
                      other_volumes_));
    return std::move(out_);
  }

 private:
  void read_head() {
    text_.rest_of_line();  // "# vtk DataFile Version x.y"
    text_.rest_of_line();  // title
    const std::string_view coding = text_.word();
    if (coding != "ASCII" && coding != "BINARY") text_.fail("must be ASCII or BINARY");
    binary_ = coding == "BINARY";
    out_.format = binary_ ? "VTK (binary)" : "VTK (ascii)";
    if (text_.word() != "DATASET") text_.fail("DATASET should be here");
    const std::string_view kind = text_.word();
    is_grid_ = kind == "UNSTRUCTURED_GRID";
    if (!is_grid_ && kind != "POLYDATA")
      text_.fail("only UNSTRUCTURED_GRID and POLYDATA can be read; convert the data set");
  }

  void read_section(const std::string& keyword) {
    if (keyword == "POINTS") {
      read_points();
    } else if (keyword == "CELLS") {
      cells_ = read_cells();
    } else if (keyword == "CELL_TYPES") {
      const std::size_t count = counted("the number of cells", binary_ ? 4 : 2);
      begin_data();
      types_.resize(count);
      for (std::int64_t& type : types_) type = integer("int");
      end_data();
    } else if (keyword == "POLYGONS") {
      add_polygons(read_cells());
    } else if (keyword == "TRIANGLE_STRIPS") {
      add_strips(read_cells());
    } else if (keyword == "VERTICES" || keyword == "LINES") {
      read_cells();
    } else if (keyword == "METADATA") {
      skip_metadata();
    } else if (keyword == "FIELD") {
      skip_field();
    } else {
      text_.fail(
          "a section (POINTS, CELLS, POLYGONS, ..) should be here; the count before may be "
          "wrong");
    }
  }

  std::size_t counted(std::string_view what, std::size_t bytes_each) {
    return text_.count(what, bytes_each);
  }

  void begin_data() {
    if (!binary_) return;
    text_.rest_of_line();
    in_.emplace(source_.path, source_.bytes, text_.position(), std::endian::big);
  }
  void end_data() {
    if (!in_) return;
    text_.move_to(in_->position());
    in_.reset();
  }
  double real(std::string_view type) {
    if (!in_) return text_.real("a coordinate");
    return type == "float" ? static_cast<double>(in_->read<float>()) : in_->read<double>();
  }
  std::int64_t integer(std::string_view type) {
    if (!in_) return text_.integer("an index");
    return bytes_of(type) == 8 ? in_->read<std::int64_t>() : in_->read<std::int32_t>();
  }

  void read_points() {
    const std::size_t count = counted("the number of points", 6);
    const std::string type(text_.word());
    if (type != "float" && type != "double") text_.fail("points must be float or double");
    begin_data();
    if (in_) in_->require_room(count, 3 * bytes_of(type), "the number of points");
    for (std::size_t i = 0; i < count; ++i) {
      Vec3 v;
      for (double& x : v) x = real(type);
      out_.vertices.push_back(v);
      if (!in_) out_.vertex_lines.push_back(text_.line());
    }
    end_data();
  }

  std::uint32_t corner(std::int64_t index) const {
    if (index < 0 || index >= std::numeric_limits<std::uint32_t>::max())
      text_.fail(fmt::format("point index {} is impossible", index));
    return static_cast<std::uint32_t>(index);
  }

  /// Looks without moving: what comes next may be binary, where blanks count.
  bool next_line_is_offsets() const {
    const std::string_view rest = text_.text().substr(text_.position());
    const std::size_t line_end = rest.find('\n');
    return line_end != std::string_view::npos && rest.substr(line_end + 1).starts_with("OFFSETS");
  }

  Cells read_cells() {
    const std::size_t count = counted("the number of cells", 2);
    const std::size_t size = counted("the size of the cells", binary_ ? 4 : 2);
    if (next_line_is_offsets()) return read_offsets(count, size);
    begin_data();
    if (in_) in_->require_room(size, 4, "the size of the cells");
    Cells cells;
    std::size_t left = size;
    for (std::size_t i = 0; i < count; ++i) {
      const std::int64_t corners = integer("int");
      if (corners < 0 || static_cast<std::uint64_t>(corners) >= left)
        text_.fail(fmt::format("a cell of {} points where {} numbers are left", corners, left));
      left -= static_cast<std::size_t>(corners) + 1;
      for (std::int64_t k = 0; k < corners; ++k) cells.corners.push_back(corner(integer("int")));
      cells.first.push_back(cells.corners.size());
    }
    end_data();
    return cells;
  }

  /// Version 5: count offsets (one more than cells), then size corners.
  Cells read_offsets(std::size_t count, std::size_t size) {
    text_.word();
    const std::string offset_type(text_.word());
    begin_data();
    if (in_) in_->require_room(count, bytes_of(offset_type) == 8 ? 8 : 4, "the number of offsets");
    Cells cells;
    cells.first.clear();
    for (std::size_t i = 0; i < count; ++i) {
      const std::int64_t offset = integer(offset_type);
      if (offset < 0 || static_cast<std::uint64_t>(offset) > size ||
          (!cells.first.empty() && static_cast<std::size_t>(offset) < cells.first.back()))
        text_.fail(fmt::format("offset {} is impossible", offset));
      cells.first.push_back(static_cast<std::size_t>(offset));
    }
    end_data();
    if (text_.word() != "CONNECTIVITY") text_.fail("CONNECTIVITY should be here");
    const std::string type(text_.word());
    begin_data();
    if (in_) in_->require_room(size, bytes_of(type) == 8 ? 8 : 4, "the size of the cells");
    for (std::size_t i = 0; i < size; ++i) cells.corners.push_back(corner(integer(type)));
    end_data();
    if (cells.first.empty()) cells.first.push_back(0);
    return cells;
  }

  void add_polygon(const std::uint32_t* begin, std::size_t corners) {
    if (corners < 3) return;
    out_.corners.insert(out_.corners.end(), begin, begin + corners);
    out_.end_polygon();
  }
  void add_polygons(const Cells& cells) {
    for (std::size_t i = 0; i < cells.count(); ++i)
      add_polygon(cells.corners.data() + cells.first[i], cells.first[i + 1] - cells.first[i]);
  }
  void add_strip(const std::uint32_t* begin, std::size_t corners) {
    for (std::size_t k = 0; k + 2 < corners; ++k) {
      const bool odd = k % 2 == 1;
      const std::uint32_t triangle[3] = {begin[k], begin[k + (odd ? 2 : 1)],
                                         begin[k + (odd ? 1 : 2)]};
      add_polygon(triangle, 3);
    }
  }
  void add_strips(const Cells& cells) {
    for (std::size_t i = 0; i < cells.count(); ++i)
      add_strip(cells.corners.data() + cells.first[i], cells.first[i + 1] - cells.first[i]);
  }

  void add_grid_cells() {
    if (types_.size() != cells_.count())
      text_.fail(fmt::format("{} cells but {} cell types", cells_.count(), types_.size()));
    for (std::size_t i = 0; i < types_.size(); ++i) {
      const std::uint32_t* c = cells_.corners.data() + cells_.first[i];
      add_grid_cell(types_[i], c, cells_.first[i + 1] - cells_.first[i]);
    }
  }

  /// Cells of higher order list their corners first and count as straight ones.
  void add_grid_cell(std::int64_t type, const std::uint32_t* c, std::size_t corners) {
    const auto need = [&](std::size_t n) {
      if (corners < n) text_.fail(fmt::format("a cell of type {} with {} points", type, corners));
      return n;
    };
    switch (type) {
      case 5:
      case 22:
        return add_polygon(c, need(3));
      case 9:
      case 23:
        return add_polygon(c, need(4));
      case 7:
        return add_polygon(c, corners);
      case 6:
        return add_strip(c, corners);
      case 8: {  // a pixel's points are ordered by axis
        need(4);
        const std::uint32_t quad[4] = {c[0], c[1], c[3], c[2]};
        return add_polygon(quad, 4);
      }
      case 10:
      case 24:
        need(4);
        out_.tetrahedra.push_back({c[0], c[1], c[2], c[3]});
        return;
      default:
        if (type >= 11 && type != 21) ++other_volumes_;  // 21 is an edge
    }
  }

  /// Lines up to an empty one.
  void skip_metadata() {
    text_.rest_of_line();
    while (text_.remaining() > 0 &&
           text_.rest_of_line().find_first_not_of(" \t") != std::string_view::npos) {
    }
  }

  void skip_field() {
    text_.required("the name of a field");
    const std::size_t arrays = counted("the number of arrays", 4);
    for (std::size_t i = 0; i < arrays; ++i) {
      text_.required("the name of an array");
      const std::size_t components = counted("the number of components", 1);
      const std::size_t tuples = counted("the number of tuples", 1);
      const std::string type(text_.required("the type of an array"));
      const std::size_t bytes = bytes_of(type);
      const std::uint64_t values = std::uint64_t{components} * tuples;
      if (binary_ && bytes == 0) text_.fail("an array of a type without a fixed size");
      if (components > 0 && tuples > text_.remaining() / components)
        text_.fail("an array larger than the file");
      begin_data();
      if (in_)
        in_->skip(values * bytes);
      else
        for (std::uint64_t k = 0; k < values; ++k) text_.required("a value");
      end_data();
    }
  }

  const Source& source_;
  TextReader text_;
  std::optional<BinaryReader> in_;  // while binary data is being read
  bool binary_ = false;
  bool is_grid_ = false;
  Cells cells_;
  std::vector<std::int64_t> types_;
  std::size_t other_volumes_ = 0;
  Import out_;
};

}  // namespace

Import read_vtk(const Source& source) { return VtkReader(source).read(); }

}  // namespace gotai::geometry::detail
