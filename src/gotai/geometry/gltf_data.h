/// @file
/// glTF 2.0 without the geometry: JSON, buffers, accessors. Internal to the module.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "gotai/geometry/import.h"

namespace gotai::geometry::detail {

/// The document of a .gltf or .glb file and its buffers.
class GltfData {
 public:
  /// Parses the JSON (nesting bounded) and fetches the buffers: the file's own, base64, or files
  /// beside it (relative paths without "..").
  explicit GltfData(const Source& source);

  const nlohmann::json& document() const { return document_; }

  /// Entry `index` of the top-level array `name`.
  const nlohmann::json& entry(const char* name, std::size_t index) const;

  /// A count, an index, an offset; 3.0 is one too, anything else but a whole number is an error.
  std::uint64_t whole_number(const nlohmann::json& value) const;

  /// The same of a member that may be missing.
  std::uint64_t whole_number(const nlohmann::json& object, const char* key,
                             std::uint64_t when_missing) const;

  /// All components of an accessor, converted (normalised integers to [-1, 1] or [0, 1]).
  /// @param components  how many per element it must have
  std::vector<double> read_accessor(std::size_t index, std::size_t components) const;

  [[noreturn]] void fail(std::string_view reason) const;

 private:
  void split_glb(std::string_view bytes, std::string_view& json);
  std::string fetch(const std::string& uri) const;

  Source source_;
  nlohmann::json document_;
  std::string_view binary_chunk_;
  bool has_binary_chunk_ = false;
  std::vector<std::string> fetched_;
  std::vector<std::string_view> buffers_;
};

/// Bytes of base64 text (RFC 4648).
/// @returns false when a character is none of its
bool decode_base64(std::string_view text, std::string& bytes);

}  // namespace gotai::geometry::detail
