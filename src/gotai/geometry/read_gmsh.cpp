// Gmsh .msh: 1.0, 2.x, 4.0, 4.1, ascii and binary (Gmsh reference manual, "File formats").
// Only nodes and elements matter; every other section is skipped, private ones included.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <utility>

#include "gotai/geometry/import.h"
#include "gotai/geometry/text_reader.h"

namespace gotai::geometry::detail {

namespace {

/// Nodes of Gmsh's element types; 0 for unknown ones.
constexpr std::array<std::uint8_t, 32> kNodes = {0,  2,  3,  4,  4, 8, 6,  5,  3,  6, 9,
                                                 10, 27, 18, 14, 1, 8, 20, 15, 13, 9, 10,
                                                 12, 15, 15, 21, 4, 5, 6,  20, 35, 56};

/// Corners of a face; 0 for what is none. Elements of higher order list their corners first.
std::size_t face_corners(std::int64_t type) {
  switch (type) {
    case 2:
    case 9:
    case 20:
    case 21:
    case 22:
    case 23:
    case 24:
    case 25:
      return 3;
    case 3:
    case 10:
    case 16:
      return 4;
    default:
      return 0;
  }
}

bool is_tetrahedron(std::int64_t type) {
  return type == 4 || type == 11 || (type >= 29 && type <= 31);
}

bool is_other_volume(std::int64_t type) {
  return (type >= 5 && type <= 7) || (type >= 12 && type <= 14) || (type >= 17 && type <= 19);
}

class GmshReader {
 public:
  explicit GmshReader(const Source& source) : source_(source), text_(source.path, source.bytes) {
    out_.format = "gmsh 1.0";
  }

  Import read() {
    while (!text_.at_end()) {
      const std::string section(text_.word());
      if (section.front() != '$')
        text_.fail("a section ('$Name') should begin here; the count before may be wrong");
      if (section == "$MeshFormat") read_format();
      if (section == "$NOD" || section == "$Nodes") read_nodes();
      if (section == "$ELM" || section == "$Elements") read_elements();
      skip_to_end(section);
    }
    if (other_volumes_ > 0)
      out_.notes.push_back(
          fmt::format("{} volume elements are no tetrahedra and were ignored; "
                      "mesh the solid with tetrahedra to keep them",
                      other_volumes_));
    if (curved_) out_.notes.emplace_back("elements of higher order were taken as straight ones");
    return std::move(out_);
  }

 private:
  bool is_4_0() const { return version_ >= 4.0 && version_ < 4.1; }

  void read_format() {
    version_ = text_.real("the version");
    binary_ = text_.integer("the file type") == 1;
    const std::int64_t data_size = text_.integer("the data size");
    if (!(version_ >= 2.0 && version_ < 5.0))
      text_.fail(
          fmt::format("gmsh version {} is not known; save the mesh as version 4.1", version_));
    if (data_size != 8)
      text_.fail(fmt::format("data size {} is not supported; save the mesh with 8", data_size));
    out_.format = fmt::format("gmsh {} ({})", version_, binary_ ? "binary" : "ascii");
    if (!binary_) return;
    begin_data();
    if (in_->read<std::int32_t>() == 1) return;
    order_ = std::endian::big;
    begin_data();
    if (in_->read<std::int32_t>() != 1) text_.fail("the number that tells the byte order is wrong");
  }

  /// Binary data begins after the line break.
  void begin_data() {
    if (!binary_) return;
    if (!in_) text_.rest_of_line();
    in_.emplace(source_.path, source_.bytes, text_.position(), order_);
  }

  std::int64_t integer(std::string_view what) {
    return binary_ ? in_->read<std::int32_t>() : text_.integer(what);
  }
  /// A number that version 4 writes with 8 bytes.
  std::int64_t long_integer(std::string_view what) {
    return binary_ ? in_->read<std::int64_t>() : text_.integer(what);
  }
  double real() { return binary_ ? in_->read<double>() : text_.real("a coordinate"); }

  std::size_t checked_count(std::int64_t count, std::string_view what, std::size_t bytes_text,
                            std::size_t bytes_binary) {
    if (count < 0) text_.fail(fmt::format("{} is {}", what, count));
    const auto n = static_cast<std::uint64_t>(count);
    if (binary_)
      in_->require_room(n, bytes_binary, what);
    else
      text_.require_room(n, bytes_text, what);
    return static_cast<std::size_t>(count);
  }

  void read_nodes() {
    if (version_ < 4.0) {
      const std::size_t count = text_.count("the number of nodes", 8);
      begin_data();
      for (std::size_t i = 0; i < count; ++i) {
        const std::int64_t tag = integer("a node number");
        read_point(tag);
      }
    } else {
      begin_data();
      const std::int64_t blocks = long_integer("the number of blocks");
      checked_count(long_integer("the number of nodes"), "the number of nodes", 8, 28);
      if (!is_4_0()) skip_tag_range();
      for (std::int64_t b = 0; b < blocks; ++b) read_node_block();
    }
    index_nodes();
  }

  void skip_tag_range() {
    long_integer("the smallest tag");
    long_integer("the largest tag");
  }

  void read_node_block() {
    const std::int64_t first = integer("an entity");
    const std::int64_t second = integer("an entity");
    const std::int64_t dimension = is_4_0() ? second : first;
    const bool parametric = integer("the parametric flag") != 0;
    const std::size_t count =
        checked_count(long_integer("the number of nodes"), "the number of nodes", 8, 28);
    const std::int64_t parameters = parametric ? std::clamp<std::int64_t>(dimension, 0, 3) : 0;
    std::vector<std::int64_t> tags(is_4_0() ? 0 : count);
    for (std::int64_t& tag : tags) tag = long_integer("a node number");
    for (std::size_t i = 0; i < count; ++i) {
      read_point(is_4_0() ? integer("a node number") : tags[i]);
      for (std::int64_t k = 0; k < parameters; ++k) real();
    }
  }

  void read_point(std::int64_t tag) {
    Vec3 p;
    for (double& x : p) x = real();
    tags_.emplace_back(tag, static_cast<std::uint32_t>(out_.vertices.size()));
    out_.vertices.push_back(p);
    if (!binary_) out_.vertex_lines.push_back(text_.line());
  }

  void index_nodes() {
    std::ranges::sort(tags_);
    const auto twice = std::ranges::adjacent_find(
        tags_, [](const auto& a, const auto& b) { return a.first == b.first; });
    if (twice != tags_.end()) text_.fail(fmt::format("node number {} is used twice", twice->first));
  }

  std::uint32_t vertex_of(std::int64_t tag) const {
    const auto it =
        std::ranges::lower_bound(tags_, tag, {}, [](const auto& entry) { return entry.first; });
    if (it == tags_.end() || it->first != tag)
      text_.fail(fmt::format("an element refers to node {}, which is not in the file", tag));
    return it->second;
  }

  void read_elements() {
    if (version_ < 4.0) {
      const std::size_t count = text_.count("the number of elements", 4);
      begin_data();
      if (binary_)
        read_old_binary_elements(count);
      else
        for (std::size_t i = 0; i < count; ++i) read_old_element();
      return;
    }
    begin_data();
    const std::int64_t blocks = long_integer("the number of blocks");
    checked_count(long_integer("the number of elements"), "the number of elements", 4, 8);
    if (!is_4_0()) skip_tag_range();
    for (std::int64_t b = 0; b < blocks; ++b) {
      integer("an entity");
      integer("an entity");
      const std::int64_t type = integer("an element type");
      const std::size_t count =
          checked_count(long_integer("the number of elements"), "the number of elements", 4, 8);
      for (std::size_t i = 0; i < count; ++i) {
        is_4_0() ? integer("an element number") : long_integer("an element number");
        read_corners(type, !is_4_0());
      }
    }
  }

  /// Versions 1 and 2: number, type, then the tags (1: two of them and the count of nodes; 2: their
  /// count first), then the nodes.
  void read_old_element() {
    text_.integer("an element number");
    const std::int64_t type = text_.integer("an element type");
    const std::int64_t tags = version_ < 2.0 ? 3 : text_.integer("the number of tags");
    for (std::int64_t k = 0; k < tags; ++k) text_.integer("a tag");
    read_corners(type, false);
  }

  void read_old_binary_elements(std::size_t count) {
    for (std::size_t done = 0; done < count;) {
      const std::int64_t type = in_->read<std::int32_t>();
      const std::int64_t follow = in_->read<std::int32_t>();
      const std::int64_t tags = in_->read<std::int32_t>();
      if (follow <= 0 || tags < 0) text_.fail("a block of elements has an impossible header");
      for (std::int64_t i = 0; i < follow; ++i, ++done) {
        in_->skip(4 * (1 + static_cast<std::uint64_t>(tags)));
        read_corners(type, false);
      }
    }
  }

  void read_corners(std::int64_t type, bool long_tags) {
    const std::size_t nodes =
        type > 0 && type < std::ssize(kNodes) ? kNodes[static_cast<std::size_t>(type)] : 0;
    if (nodes == 0) text_.fail(fmt::format("element type {} is not known", type));
    std::array<std::int64_t, 64> tags;
    for (std::size_t k = 0; k < nodes; ++k)
      tags[k] = long_tags ? long_integer("a node number") : integer("a node number");
    const std::size_t line = text_.line();
    if (const std::size_t corners = face_corners(type); corners > 0) {
      for (std::size_t k = 0; k < corners; ++k) out_.corners.push_back(vertex_of(tags[k]));
      out_.end_polygon();
      if (!binary_) out_.polygon_lines.push_back(line);
      curved_ |= nodes > corners;
    } else if (is_tetrahedron(type)) {
      Tetrahedron tet;
      for (std::size_t k = 0; k < 4; ++k) tet[k] = vertex_of(tags[k]);
      out_.tetrahedra.push_back(tet);
      if (!binary_) out_.tetrahedron_lines.push_back(line);
      curved_ |= nodes > 4;
    } else if (is_other_volume(type)) {
      ++other_volumes_;
    }
  }

  void skip_to_end(const std::string& section) {
    if (in_) {
      text_.move_to(in_->position());
      in_.reset();
    }
    const std::string end = section == "$NOD"   ? "$ENDNOD"
                            : section == "$ELM" ? "$ENDELM"
                                                : "$End" + section.substr(1);
    const std::size_t at = source_.bytes.find(end, text_.position());
    if (at == std::string_view::npos)
      text_.fail(fmt::format("section {} does not end with {}; the file is truncated",
                             section.substr(0, 40), end.substr(0, 40)));
    text_.move_to(at + end.size());
  }

  const Source& source_;
  TextReader text_;
  std::optional<BinaryReader> in_;  // while binary data is being read
  std::endian order_ = std::endian::little;
  double version_ = 1.0;
  bool binary_ = false;
  bool curved_ = false;
  std::size_t other_volumes_ = 0;
  std::vector<std::pair<std::int64_t, std::uint32_t>> tags_;  // node number, vertex; sorted
  Import out_;
};

}  // namespace

Import read_gmsh(const Source& source) { return GmshReader(source).read(); }

}  // namespace gotai::geometry::detail
