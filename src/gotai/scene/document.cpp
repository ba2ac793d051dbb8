#include "gotai/scene/document.h"

#define TOML_ENABLE_FORMATTERS 0
#include <fmt/format.h>
#include <toml++/toml.h>

#include <charconv>
#include <optional>

#include "gotai/core/error.h"

namespace gotai::scene {
namespace {

Location location_of(const toml::source_region& source, const std::string& path) {
  return {path, source.begin.line, source.begin.column};
}

Node convert(const toml::node& node, const std::string& path) {
  Node out;
  out.where = location_of(node.source(), path);
  if (const auto* table = node.as_table()) {
    Node::Table entries;
    entries.reserve(table->size());
    for (const auto& [key, value] : *table) {
      entries.push_back(
          {std::string(key.str()), location_of(key.source(), path), convert(value, path)});
    }
    out.value = std::move(entries);
  } else if (const auto* array = node.as_array()) {
    Node::Array elements;
    elements.reserve(array->size());
    for (const auto& element : *array) elements.push_back(convert(element, path));
    out.value = std::move(elements);
  } else if (const auto* text = node.as_string()) {
    out.value = text->get();
  } else if (const auto* integer = node.as_integer()) {
    out.value = integer->get();
  } else if (const auto* number = node.as_floating_point()) {
    out.value = number->get();
  } else if (const auto* boolean = node.as_boolean()) {
    out.value = boolean->get();
  } else {
    fail(out.where, "dates and times have no meaning in a scene");
  }
  return out;
}

/// The value of an override: TOML when it can be read as such, else the text itself.
Node parse_value(const std::string& text, const Location& where) {
  const auto relocate = [&where](Node& node, const auto& self) -> void {
    node.where = where;
    if (auto* array = std::get_if<Node::Array>(&node.value)) {
      for (Node& element : *array) self(element, self);
    } else if (auto* table = std::get_if<Node::Table>(&node.value)) {
      for (Entry& entry : *table) {
        entry.where = where;
        self(entry.value, self);
      }
    }
  };
  try {
    Node parsed = parse_document("value = " + text, where.file);
    auto& table = std::get<Node::Table>(parsed.value);
    if (table.size() == 1) {
      relocate(table.front().value, relocate);
      return std::move(table.front().value);
    }
  } catch (const FileError&) {
    // A bare word: --set impulse.method=penalty
  }
  return {where, text};
}

std::optional<std::size_t> parse_index(std::string_view text) {
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), index);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return index;
}

/// Follows one step of a dotted path, adding tables that are not there yet.
Node& descend(Node& node, std::string_view step, const Location& where) {
  if (auto* array = std::get_if<Node::Array>(&node.value)) {
    const auto index = parse_index(step);
    if (!index || *index >= array->size()) {
      fail(where, fmt::format("\"{}\" is no index of an array with {} elements (counted from 0)",
                              step, array->size()));
    }
    return (*array)[*index];
  }
  auto* table = std::get_if<Node::Table>(&node.value);
  if (table == nullptr) {
    fail(where, fmt::format("\"{}\" cannot be set inside of {}", step, node.type_name()));
  }
  for (Entry& entry : *table) {
    if (entry.key == step) return entry.value;
  }
  table->push_back({std::string(step), where, {where, Node::Table{}}});
  return table->back().value;
}

}  // namespace

const Node* Node::find(std::string_view key) const {
  const Table* entries = table();
  if (entries == nullptr) return nullptr;
  for (const Entry& entry : *entries) {
    if (entry.key == key) return &entry.value;
  }
  return nullptr;
}

std::string_view Node::type_name() const {
  constexpr std::string_view names[] = {"a boolean", "an integer", "a number",
                                        "a text",    "an array",   "a table"};
  return names[value.index()];
}

Node parse_document(std::string_view text, const std::string& path) {
  try {
    const toml::table table = toml::parse(text, path);
    return convert(table, path);
  } catch (const toml::parse_error& error) {
    const Location where = location_of(error.source(), path);
    throw FileError(path, where.line, where.column, error.description());
  }
}

void apply_override(Node& document, const std::string& assignment) {
  const Location where{"--set " + assignment, 0, 0};
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0) {
    fail(where, "write it as key=value, for example --set time.step=0.01");
  }
  std::string_view path = std::string_view(assignment).substr(0, equals);
  Node* node = &document;
  while (!path.empty()) {
    const std::size_t dot = path.find('.');
    const std::string_view step = path.substr(0, dot);
    if (step.empty()) fail(where, "the key has an empty part between its dots");
    node = &descend(*node, step, where);
    if (dot == std::string_view::npos) break;
    path.remove_prefix(dot + 1);
    if (path.empty()) fail(where, "the key ends with a dot");
  }
  *node = parse_value(assignment.substr(equals + 1), where);
}

void fail(const Location& where, std::string_view reason) {
  throw FileError(where.file, where.line, where.column, reason);
}

}  // namespace gotai::scene
