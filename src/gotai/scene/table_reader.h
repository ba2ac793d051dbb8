/// @file
/// Reads the keys of one table with types, ranges and defaults; what is not read is an error.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gotai/core/types.h"
#include "gotai/scene/document.h"

namespace gotai::scene {

/// Allowed values of a number.
struct Range {
  double low;
  double high;
  std::string_view text;  ///< as in "must be > 0"
};

namespace range {
extern const Range any;           ///< finite
extern const Range positive;      ///< > 0
extern const Range non_negative;  ///< >= 0
extern const Range unit;          ///< 0 .. 1
}  // namespace range

/// Reads one table. Every accessor marks its key as known; finish() refuses all others. All throw
/// FileError with line, column, the value and what is allowed.
class TableReader {
 public:
  /// @param title  how messages call the table: "[material]"
  TableReader(const Node& node, std::string title);

  /// The key's value, or nullptr when it is absent.
  const Node* find(std::string_view key);
  /// The key's value. @throws FileError when it is absent
  const Node& require(std::string_view key);

  double number(std::string_view key, double fallback, const Range& range);
  std::optional<double> optional_number(std::string_view key, const Range& range);
  std::int64_t integer(std::string_view key, std::int64_t fallback, std::int64_t low,
                       std::int64_t high);
  bool boolean(std::string_view key, bool fallback);
  std::string text(std::string_view key, const std::string& fallback);
  Vec3 vector(std::string_view key, const Vec3& fallback);
  std::optional<Vec3> optional_vector(std::string_view key);

  /// @throws FileError naming the first key that no accessor asked for, with the nearest known one
  void finish() const;

  const Location& where() const { return node_.where; }
  const std::string& title() const { return title_; }

 private:
  const Node& node_;
  std::string title_;
  std::vector<std::string> known_;
};

// The values themselves, for elements of arrays. `name` is how messages call the value.
double read_number(const Node& node, std::string_view name, const Range& range);
std::int64_t read_integer(const Node& node, std::string_view name, std::int64_t low,
                          std::int64_t high);
const std::string& read_text(const Node& node, std::string_view name);
Vec3 read_vector(const Node& node, std::string_view name);
/// The elements of an array of tables. @throws FileError when it is something else
const Node::Array& read_array(const Node& node, std::string_view name);
/// Numbers of an array that must have exactly this many.
std::vector<double> read_numbers(const Node& node, std::string_view name, std::size_t count);

}  // namespace gotai::scene
