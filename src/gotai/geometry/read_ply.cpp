// Stanford PLY: ascii, binary of both byte orders. Only vertex positions and faces matter.
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

enum class Type { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

std::optional<Type> type_of(std::string_view name) {
  static constexpr std::array<std::pair<std::string_view, Type>, 16> kNames = {
      {{"char", Type::kInt8},
       {"int8", Type::kInt8},
       {"uchar", Type::kUint8},
       {"uint8", Type::kUint8},
       {"short", Type::kInt16},
       {"int16", Type::kInt16},
       {"ushort", Type::kUint16},
       {"uint16", Type::kUint16},
       {"int", Type::kInt32},
       {"int32", Type::kInt32},
       {"uint", Type::kUint32},
       {"uint32", Type::kUint32},
       {"float", Type::kFloat},
       {"float32", Type::kFloat},
       {"double", Type::kDouble},
       {"float64", Type::kDouble}}};
  for (const auto& [known, type] : kNames)
    if (known == name) return type;
  return std::nullopt;
}

std::size_t size_of(Type type) {
  static constexpr std::array<std::size_t, 8> kSizes = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

struct Property {
  std::string name;
  Type type = Type::kFloat;
  std::optional<Type> count_type;  // for lists
};

struct Element {
  std::string name;
  std::int64_t count = 0;
  std::vector<Property> properties;

  /// Fewest bytes of a row.
  std::size_t least_bytes(bool binary) const {
    std::size_t bytes = 0;
    for (const Property& p : properties) bytes += size_of(p.count_type.value_or(p.type));
    return binary ? bytes : std::max<std::size_t>(1, 2 * properties.size());
  }
};

/// Where a row's values come from: the words of a line, or bytes.
class Row {
 public:
  Row(TextReader& text, BinaryReader* binary) : text_(text), binary_(binary) {}

  double value(Type type) {
    if (binary_ == nullptr) {
      const std::string_view word = text_.word_on_line();
      if (word.empty()) text_.fail("the line has fewer numbers than the header declares");
      return text_.to_real(word, "a property");
    }
    switch (type) {
      case Type::kInt8:
        return binary_->read<std::int8_t>();
      case Type::kUint8:
        return binary_->read<std::uint8_t>();
      case Type::kInt16:
        return binary_->read<std::int16_t>();
      case Type::kUint16:
        return binary_->read<std::uint16_t>();
      case Type::kInt32:
        return binary_->read<std::int32_t>();
      case Type::kUint32:
        return binary_->read<std::uint32_t>();
      case Type::kFloat:
        return static_cast<double>(binary_->read<float>());
      case Type::kDouble:
        break;
    }
    return binary_->read<double>();
  }
  std::size_t list_size(Type type) {
    const double n = value(type);
    const std::size_t left = binary_ != nullptr ? binary_->remaining() : text_.remaining();
    if (!(n >= 0.0 && n <= static_cast<double>(left)) ||
        n != static_cast<double>(static_cast<std::size_t>(n)))
      text_.fail(fmt::format("a list of {} entries", n));
    return static_cast<std::size_t>(n);
  }

 private:
  TextReader& text_;
  BinaryReader* binary_;
};

class PlyReader {
 public:
  explicit PlyReader(const Source& source) : source_(source), text_(source.path, source.bytes) {}

  Import read() {
    read_header();
    std::optional<BinaryReader> binary;
    if (binary_) binary.emplace(source_.path, source_.bytes, text_.position(), order_);
    for (const Element& element : elements_) {
      check_room(element, binary);
      if (element.properties.empty()) continue;
      for (std::int64_t i = 0; i < element.count; ++i) {
        if (!binary && text_.at_end())
          text_.fail(fmt::format("the file ends after {} of {} {} rows; it is truncated", i,
                                 element.count, element.name.substr(0, 40)));
        read_row(element, Row(text_, binary ? &*binary : nullptr));
        if (!binary) text_.rest_of_line();  // some exporters write more than they declare
      }
    }
    return std::move(out_);
  }

 private:
  void read_header() {
    text_.rest_of_line();  // "ply"
    while (true) {
      if (text_.at_end()) text_.fail("the header does not end with end_header");
      const std::string_view keyword = text_.word();
      if (keyword == "format") {
        read_format();
      } else if (keyword == "element") {
        Element element;
        element.name = text_.word_on_line();
        element.count = text_.integer("the number of elements");
        if (element.count < 0) text_.fail(fmt::format("{} elements", element.count));
        elements_.push_back(std::move(element));
      } else if (keyword == "property") {
        read_property();
      } else if (keyword == "end_header") {
        text_.rest_of_line();
        return;
      } else if (keyword != "comment" && keyword != "obj_info") {
        text_.fail("this is no line of a PLY header");
      }
      text_.rest_of_line();
    }
  }

  void read_format() {
    const std::string_view name = text_.word_on_line();
    if (name != "ascii" && name != "binary_little_endian" && name != "binary_big_endian")
      text_.fail("the format must be ascii, binary_little_endian or binary_big_endian");
    binary_ = name != "ascii";
    order_ = name == "binary_big_endian" ? std::endian::big : std::endian::little;
    out_.format = binary_ ? "PLY (binary)" : "PLY (ascii)";
  }

  void read_property() {
    if (elements_.empty()) text_.fail("a property before any element");
    Property property;
    std::string_view type = text_.word_on_line();
    if (type == "list") {
      property.count_type = type_of(text_.word_on_line());
      if (!property.count_type) text_.fail("unknown type of a list's count");
      type = text_.word_on_line();
    }
    if (!type_of(type)) text_.fail("unknown type of a property");
    property.type = *type_of(type);
    property.name = text_.word_on_line();
    elements_.back().properties.push_back(std::move(property));
  }

  void check_room(const Element& element, const std::optional<BinaryReader>& binary) const {
    const std::string what = "the number of " + element.name.substr(0, 40) + " elements";
    const auto count = static_cast<std::uint64_t>(element.count);
    if (binary)
      binary->require_room(count, element.least_bytes(true), what);
    else
      text_.require_room(count, element.least_bytes(false), what);
  }

  void read_row(const Element& element, Row row) {
    const bool is_vertex = element.name == "vertex";
    const bool is_face = element.name == "face";
    Vec3 position = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    for (const Property& property : element.properties) {
      if (property.count_type) {
        const bool is_corners =
            is_face && (property.name == "vertex_indices" || property.name == "vertex_index");
        const std::size_t size = row.list_size(*property.count_type);
        for (std::size_t k = 0; k < size; ++k) {
          const double value = row.value(property.type);
          if (is_corners) add_corner(value);
        }
        if (is_corners) end_face(size);
        continue;
      }
      const double value = row.value(property.type);
      if (is_vertex && property.name.size() == 1 && property.name[0] >= 'x' &&
          property.name[0] <= 'z')
        position[property.name[0] - 'x'] = value;
    }
    if (!is_vertex) return;
    out_.vertices.push_back(position);
    if (!binary_) out_.vertex_lines.push_back(text_.line());
  }

  void add_corner(double value) {
    if (!(value >= 0.0 && value < 4294967295.0))
      text_.fail(fmt::format("vertex index {} is impossible", value));
    out_.corners.push_back(static_cast<std::uint32_t>(value));
  }

  void end_face(std::size_t size) {
    if (size < 3) {  // points and lines
      out_.corners.resize(out_.first.back());
      return;
    }
    out_.end_polygon();
    if (!binary_) out_.polygon_lines.push_back(text_.line());
  }

  const Source& source_;
  TextReader text_;
  bool binary_ = false;
  std::endian order_ = std::endian::little;
  std::vector<Element> elements_;
  Import out_;
};

}  // namespace

Import read_ply(const Source& source) { return PlyReader(source).read(); }

}  // namespace gotai::geometry::detail
