/// @file
/// A scene file as a tree of values that remember where they were written, so that every error can
/// name file, line and column. The only place that knows TOML is document.cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gotai::scene {

/// Where a value was written.
struct Location {
  std::string file;        ///< path, or "--set key=value" for an override
  std::size_t line = 0;    ///< 1-based; 0 when it does not apply
  std::size_t column = 0;  ///< 1-based; 0 when it does not apply
};

struct Entry;

/// A value: boolean, integer, number, text, array or table. Tables keep the order of their keys as
/// the parser gives it (alphabetical).
struct Node {
  using Array = std::vector<Node>;
  using Table = std::vector<Entry>;

  Location where;
  std::variant<bool, std::int64_t, double, std::string, Array, Table> value;

  const Table* table() const { return std::get_if<Table>(&value); }
  const Array* array() const { return std::get_if<Array>(&value); }
  /// Value of a key of a table; nullptr when there is none.
  const Node* find(std::string_view key) const;
  /// What it is, for messages: "a number", "a table"
  std::string_view type_name() const;
};

/// One key of a table.
struct Entry {
  std::string key;
  Location where;  ///< of the key
  Node value;
};

/// Reads TOML text.
/// @param path  for messages only
/// @throws FileError with line and column for anything that is not TOML
Node parse_document(std::string_view text, const std::string& path);

/// Replaces or adds one value, as `--set` does.
/// @param assignment  "dotted.path=value"; elements of arrays by their index ("bodies.0.mass=2");
///                    the value as in TOML, or a bare word ("impulse.method=penalty")
/// @throws FileError naming the assignment when the path cannot be followed
void apply_override(Node& document, const std::string& assignment);

/// @throws FileError always
[[noreturn]] void fail(const Location& where, std::string_view reason);

}  // namespace gotai::scene
