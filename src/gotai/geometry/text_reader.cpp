#include "gotai/geometry/text_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>

#include "gotai/core/error.h"

namespace gotai::geometry::detail {

namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

/// Text from a file for a message: short, printable.
std::string quoted(std::string_view text) {
  std::string out = "'";
  for (const char c : text.substr(0, 40))
    out += c >= ' ' && c <= '~' ? std::string(1, c)
                                : fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
  return out + (text.size() > 40 ? "...'" : "'");
}

}  // namespace

TextReader::TextReader(std::filesystem::path path, std::string_view text, char comment)
    : path_(std::move(path)), text_(text), comment_(comment) {}

void TextReader::skip_blanks(bool across_lines) {
  while (position_ < text_.size()) {
    const char c = text_[position_];
    if (c == '\n') {
      if (!across_lines) return;
      ++line_;
      ++position_;
    } else if (comment_ != '\0' && c == comment_) {
      position_ = std::min(text_.find('\n', position_), text_.size());
    } else if (is_blank(c)) {
      ++position_;
    } else {
      return;
    }
  }
}

std::string_view TextReader::word_on_line() {
  skip_blanks(false);
  const std::size_t begin = position_;
  while (position_ < text_.size() && !is_blank(text_[position_]) && text_[position_] != '\n' &&
         (comment_ == '\0' || text_[position_] != comment_))
    ++position_;
  return text_.substr(begin, position_ - begin);
}

std::string_view TextReader::word() {
  skip_blanks(true);
  return word_on_line();
}

std::string_view TextReader::peek() {
  skip_blanks(true);
  const std::size_t begin = position_;
  const std::string_view next = word_on_line();
  position_ = begin;
  return next;
}

std::string_view TextReader::rest_of_line() {
  const std::size_t end = std::min(text_.find('\n', position_), text_.size());
  std::string_view line = text_.substr(position_, end - position_);
  if (comment_ != '\0') line = line.substr(0, line.find(comment_));
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  position_ = end;
  if (position_ < text_.size()) {
    ++position_;
    ++line_;
  }
  return line;
}

void TextReader::move_to(std::size_t position) {
  for (; position_ < position; ++position_)
    if (text_[position_] == '\n') ++line_;
}

std::string_view TextReader::required(std::string_view what) {
  const std::string_view text = word();
  if (text.empty())
    fail(fmt::format("the file ends where {} should be; it is truncated or its counts are wrong",
                     what));
  return text;
}

double TextReader::to_real(std::string_view text, std::string_view what) const {
  std::string_view digits = text;
  if (digits.size() > 1 && digits.front() == '+') digits.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (digits.empty() || error == std::errc::invalid_argument ||
      end != digits.data() + digits.size())
    fail(fmt::format("{} is not a number where {} should be", quoted(text), what));
  // Too large becomes infinite, too small becomes zero.
  if (error == std::errc::result_out_of_range)
    return std::strtod(std::string(digits).c_str(), nullptr);
  return value;
}

std::int64_t TextReader::to_integer(std::string_view text, std::string_view what) const {
  std::string_view digits = text;
  if (digits.size() > 1 && digits.front() == '+') digits.remove_prefix(1);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (digits.empty() || error != std::errc() || end != digits.data() + digits.size())
    fail(fmt::format("{} is not an integer where {} should be", quoted(text), what));
  return value;
}

std::size_t TextReader::count(std::string_view what, std::size_t bytes_each) {
  const std::int64_t value = integer(what);
  if (value < 0) fail(fmt::format("{} is {}; it must not be negative", what, value));
  require_room(static_cast<std::uint64_t>(value), bytes_each, what);
  return static_cast<std::size_t>(value);
}

void TextReader::require_room(std::uint64_t count, std::size_t bytes_each,
                              std::string_view what) const {
  if (count > remaining() / bytes_each + 1)
    fail(
        fmt::format("{} is {}, but the {} bytes that follow cannot hold so many; the file is "
                    "truncated or its header is wrong",
                    what, count, remaining()));
}

void TextReader::fail(std::string_view reason) const {
  throw FileError(path_.string(), line_, 0, reason);
}

void BinaryReader::require(std::uint64_t bytes) const {
  if (bytes > remaining())
    fail(fmt::format("the file ends {} bytes too early; it is truncated or its counts are wrong",
                     bytes - remaining()));
}

void BinaryReader::require_room(std::uint64_t count, std::size_t bytes_each,
                                std::string_view what) const {
  if (bytes_each > 0 && count > remaining() / bytes_each)
    fail(
        fmt::format("{} is {}, but there is room for {} in the {} bytes that follow; the file is "
                    "truncated or its header is wrong",
                    what, count, remaining() / bytes_each, remaining()));
}

void BinaryReader::fail(std::string_view reason) const {
  throw FileError(path_.string(), fmt::format("byte {}: {}", position_, reason));
}

std::string lower(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return result;
}

}  // namespace gotai::geometry::detail
