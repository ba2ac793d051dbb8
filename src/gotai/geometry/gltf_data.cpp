#include "gotai/geometry/gltf_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "gotai/core/error.h"
#include "gotai/geometry/text_reader.h"

namespace gotai::geometry::detail {

namespace {

using nlohmann::json;

constexpr int kDeepestNesting = 64;
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;
constexpr std::uint32_t kBinaryChunk = 0x004E4942;

std::size_t component_bytes(std::uint64_t type) {
  switch (type) {
    case 5120:
    case 5121:
      return 1;
    case 5122:
    case 5123:
      return 2;
    case 5125:
    case 5126:
      return 4;
    default:
      return 0;
  }
}

std::size_t component_count(const std::string& type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  if (type == "VEC4") return 4;
  return 0;
}

double read_component(BinaryReader& in, std::uint64_t type, bool normalized) {
  const auto as = [normalized](auto value) {
    using T = decltype(value);
    if (!normalized) return static_cast<double>(value);
    return std::max(-1.0, static_cast<double>(value) / std::numeric_limits<T>::max());
  };
  switch (type) {
    case 5120:
      return as(in.read<std::int8_t>());
    case 5121:
      return as(in.read<std::uint8_t>());
    case 5122:
      return as(in.read<std::int16_t>());
    case 5123:
      return as(in.read<std::uint16_t>());
    case 5125:
      return as(in.read<std::uint32_t>());
    default:
      return static_cast<double>(in.read<float>());
  }
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  const char l = static_cast<char>(c | 0x20);
  return l >= 'a' && l <= 'f' ? l - 'a' + 10 : -1;
}

/// "%20" and the like.
std::string decode_percent(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size() && hex_digit(text[i + 1]) >= 0 &&
        hex_digit(text[i + 2]) >= 0) {
      out += static_cast<char>(16 * hex_digit(text[i + 1]) + hex_digit(text[i + 2]));
      i += 2;
    } else {
      out += text[i];
    }
  }
  return out;
}

}  // namespace

bool decode_base64(std::string_view text, std::string& bytes) {
  static constexpr std::string_view kAlphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::uint32_t bits = 0;
  int held = 0;
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  for (const char c : text) {
    const std::size_t digit = kAlphabet.find(c);
    if (digit == std::string_view::npos) return false;
    bits = (bits << 6U) | static_cast<std::uint32_t>(digit);
    held += 6;
    if (held >= 8) {
      held -= 8;
      bytes += static_cast<char>((bits >> held) & 0xFFU);
    }
  }
  return true;
}

GltfData::GltfData(const Source& source) : source_(source) {
  std::string_view text = source.bytes;
  if (source.bytes.starts_with("glTF")) split_glb(source.bytes, text);
  document_ = json::parse(text, [this](int depth, json::parse_event_t, json&) {
    if (depth > kDeepestNesting) fail("the JSON is nested too deeply");
    return true;
  });
  if (!document_.is_object() || !document_.contains("asset")) fail("is JSON, but not glTF");
  if (const auto& version = document_.at("asset").at("version"); version != "2.0")
    fail(fmt::format("glTF version {} is not read, only 2.0", version.dump()));
  if (!document_.contains("buffers")) return;
  for (const json& buffer : document_.at("buffers")) {
    const auto length = whole_number(buffer.at("byteLength"));
    std::string_view bytes = binary_chunk_;
    if (buffer.contains("uri")) {
      fetched_.reserve(document_.at("buffers").size());  // views into it must stay valid
      fetched_.push_back(fetch(buffer.at("uri").get<std::string>()));
      bytes = fetched_.back();
    } else if (!buffers_.empty() || !has_binary_chunk_) {
      fail(fmt::format("buffer {} has no data", buffers_.size()));
    }
    if (length > bytes.size())
      fail(fmt::format("buffer {} should have {} bytes, but there are {}; the file is truncated",
                       buffers_.size(), length, bytes.size()));
    buffers_.push_back(bytes.substr(0, length));
  }
}

void GltfData::fail(std::string_view reason) const {
  throw FileError(source_.path.string(), reason);
}

void GltfData::split_glb(std::string_view bytes, std::string_view& json_text) {
  BinaryReader in(source_.path, bytes, 4);
  const auto version = in.read<std::uint32_t>();
  if (version != 2) fail(fmt::format("GLB version {} is not read, only 2", version));
  const std::size_t length = in.read<std::uint32_t>();
  if (length > bytes.size())
    fail(fmt::format("should have {} bytes, but has {}; the file is truncated", length,
                     bytes.size()));
  while (in.position() + 8 <= length) {
    const std::size_t size = in.read<std::uint32_t>();
    const auto type = in.read<std::uint32_t>();
    const std::size_t begin = in.position();
    in.skip(size);
    if (type == kJsonChunk) json_text = bytes.substr(begin, size);
    if (type == kBinaryChunk) {
      binary_chunk_ = bytes.substr(begin, size);
      has_binary_chunk_ = true;
    }
    if (size % 4 != 0) in.skip(std::min<std::size_t>(4 - size % 4, in.remaining()));
  }
  if (json_text.data() == bytes.data()) fail("has no JSON chunk");
}

std::string GltfData::fetch(const std::string& uri) const {
  if (uri.starts_with("data:")) {
    const std::size_t comma = uri.find(";base64,");
    std::string bytes;
    if (comma == std::string::npos ||
        !decode_base64(std::string_view(uri).substr(comma + 8), bytes))
      fail("a data URI is not valid base64");
    return bytes;
  }
  const std::filesystem::path relative = decode_percent(uri);
  const bool climbs = std::ranges::any_of(relative, [](const auto& part) { return part == ".."; });
  if (relative.is_absolute() || climbs || uri.find(':') != std::string::npos)
    fail(fmt::format("buffer '{}': only files beside or below this one are read",
                     uri.substr(0, 80)));
  return read_bytes(source_.path.parent_path() / relative);
}

std::uint64_t GltfData::whole_number(const json& value) const {
  constexpr double kEndOfExactNumbers = 9007199254740992.0;  // 2^53
  if (value.is_number_unsigned()) return value.get<std::uint64_t>();
  const double number = value.is_number_float() ? value.get<double>() : -1.0;
  if (!(number >= 0.0 && number < kEndOfExactNumbers) || std::floor(number) != number)
    fail(fmt::format("{} stands where a whole number should be", value.dump().substr(0, 40)));
  return static_cast<std::uint64_t>(number);
}

std::uint64_t GltfData::whole_number(const json& object, const char* key,
                                     std::uint64_t when_missing) const {
  return object.contains(key) ? whole_number(object.at(key)) : when_missing;
}

const json& GltfData::entry(const char* name, std::size_t index) const {
  const json& array = document_.at(name);
  if (!array.is_array() || index >= array.size())
    fail(fmt::format("{} {} does not exist", name, index));
  return array[index];
}

std::vector<double> GltfData::read_accessor(std::size_t index, std::size_t components) const {
  const json& accessor = entry("accessors", index);
  if (accessor.contains("sparse") || !accessor.contains("bufferView"))
    fail(fmt::format("accessor {} is sparse; export the mesh without sparse accessors", index));
  const json& view = entry("bufferViews", whole_number(accessor.at("bufferView")));
  const auto buffer = whole_number(view.at("buffer"));
  if (buffer >= buffers_.size()) fail(fmt::format("buffer {} does not exist", buffer));

  const std::uint64_t type = whole_number(accessor.at("componentType"));
  const std::size_t bytes = component_bytes(type);
  if (bytes == 0 || component_count(accessor.at("type").get<std::string>()) != components)
    fail(fmt::format("accessor {} has the wrong type", index));
  const std::uint64_t view_offset = whole_number(view, "byteOffset", 0);
  const std::uint64_t view_length = whole_number(view.at("byteLength"));
  const std::uint64_t offset = whole_number(accessor, "byteOffset", 0);
  const std::uint64_t count = whole_number(accessor.at("count"));
  const std::uint64_t element = bytes * components;
  const std::uint64_t stride = whole_number(view, "byteStride", element);
  if (view_offset > buffers_[buffer].size() || view_length > buffers_[buffer].size() - view_offset)
    fail(fmt::format("bufferView of accessor {} is larger than its buffer", index));
  if (stride < element || stride > 4096 ||
      (count > 0 && (offset > view_length || element > view_length - offset ||
                     (count - 1) > (view_length - offset - element) / stride)))
    fail(fmt::format("accessor {} is larger than its bufferView", index));

  const bool normalized = accessor.value("normalized", false);
  const std::string_view data = buffers_[buffer].substr(view_offset, view_length);
  std::vector<double> values;
  values.reserve(count * components);
  for (std::uint64_t i = 0; i < count; ++i) {
    BinaryReader in({}, data, offset + i * stride);
    for (std::size_t k = 0; k < components; ++k)
      values.push_back(read_component(in, type, normalized));
  }
  return values;
}

}  // namespace gotai::geometry::detail
