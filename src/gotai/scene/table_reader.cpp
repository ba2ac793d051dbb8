#include "gotai/scene/table_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "gotai/scene/suggest.h"

namespace gotai::scene {
namespace {

constexpr double kMax = std::numeric_limits<double>::max();

[[noreturn]] void wrong_type(const Node& node, std::string_view name, std::string_view expected) {
  fail(node.where, fmt::format("{} must be {}, not {}", name, expected, node.type_name()));
}

}  // namespace

namespace range {
const Range any{-kMax, kMax, "must be finite"};
const Range positive{std::numeric_limits<double>::min(), kMax, "must be > 0"};
const Range non_negative{0.0, kMax, "must be >= 0"};
const Range unit{0.0, 1.0, "must be from 0 to 1"};
}  // namespace range

double read_number(const Node& node, std::string_view name, const Range& range) {
  double value = 0.0;
  if (const auto* number = std::get_if<double>(&node.value)) {
    value = *number;
  } else if (const auto* integer = std::get_if<std::int64_t>(&node.value)) {
    value = static_cast<double>(*integer);
  } else {
    wrong_type(node, name, "a number");
  }
  if (!(value >= range.low && value <= range.high)) {
    fail(node.where, fmt::format("{} = {} {}", name, value,
                                 std::isfinite(value) ? range.text : range::any.text));
  }
  return value;
}

std::int64_t read_integer(const Node& node, std::string_view name, std::int64_t low,
                          std::int64_t high) {
  const auto* integer = std::get_if<std::int64_t>(&node.value);
  if (integer == nullptr) wrong_type(node, name, "an integer");
  if (*integer < low || *integer > high) {
    fail(node.where, fmt::format("{} = {} must be from {} to {}", name, *integer, low, high));
  }
  return *integer;
}

const std::string& read_text(const Node& node, std::string_view name) {
  const auto* text = std::get_if<std::string>(&node.value);
  if (text == nullptr) wrong_type(node, name, "a text in quotes");
  return *text;
}

std::vector<double> read_numbers(const Node& node, std::string_view name, std::size_t count) {
  const Node::Array* array = node.array();
  if (array == nullptr || array->size() != count) {
    fail(node.where, fmt::format("{} must be an array of {} numbers, not {}", name, count,
                                 array == nullptr ? std::string(node.type_name())
                                                  : fmt::format("of {}", array->size())));
  }
  std::vector<double> numbers;
  for (const Node& element : *array) numbers.push_back(read_number(element, name, range::any));
  return numbers;
}

Vec3 read_vector(const Node& node, std::string_view name) {
  const std::vector<double> n = read_numbers(node, name, 3);
  return {n[0], n[1], n[2]};
}

const Node::Array& read_array(const Node& node, std::string_view name) {
  const Node::Array* array = node.array();
  if (array == nullptr) wrong_type(node, name, fmt::format("written as [[{}]]", name));
  return *array;
}

TableReader::TableReader(const Node& node, std::string title)
    : node_(node), title_(std::move(title)) {
  if (node.table() == nullptr) wrong_type(node, title_, "a table");
}

const Node* TableReader::find(std::string_view key) {
  if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.emplace_back(key);
  return node_.find(key);
}

const Node& TableReader::require(std::string_view key) {
  const Node* node = find(key);
  if (node == nullptr) fail(node_.where, fmt::format("{} needs the key \"{}\"", title_, key));
  return *node;
}

double TableReader::number(std::string_view key, double fallback, const Range& range) {
  const Node* node = find(key);
  return node == nullptr ? fallback : read_number(*node, key, range);
}

std::optional<double> TableReader::optional_number(std::string_view key, const Range& range) {
  const Node* node = find(key);
  if (node == nullptr) return std::nullopt;
  return read_number(*node, key, range);
}

std::int64_t TableReader::integer(std::string_view key, std::int64_t fallback, std::int64_t low,
                                  std::int64_t high) {
  const Node* node = find(key);
  return node == nullptr ? fallback : read_integer(*node, key, low, high);
}

bool TableReader::boolean(std::string_view key, bool fallback) {
  const Node* node = find(key);
  if (node == nullptr) return fallback;
  const auto* value = std::get_if<bool>(&node->value);
  if (value == nullptr) wrong_type(*node, key, "true or false");
  return *value;
}

std::string TableReader::text(std::string_view key, const std::string& fallback) {
  const Node* node = find(key);
  return node == nullptr ? fallback : read_text(*node, key);
}

Vec3 TableReader::vector(std::string_view key, const Vec3& fallback) {
  const Node* node = find(key);
  return node == nullptr ? fallback : read_vector(*node, key);
}

std::optional<Vec3> TableReader::optional_vector(std::string_view key) {
  const Node* node = find(key);
  if (node == nullptr) return std::nullopt;
  return read_vector(*node, key);
}

void TableReader::finish() const {
  for (const Entry& entry : *node_.table()) {
    if (std::find(known_.begin(), known_.end(), entry.key) != known_.end()) continue;
    fail(entry.where, fmt::format("unknown key \"{}\" in {}{}", entry.key, title_,
                                  suggestion(entry.key, known_)));
  }
}

}  // namespace gotai::scene
