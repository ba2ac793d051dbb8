/// @file
/// Reading numbers and words from text and binary data of unknown origin. Internal to the module.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

namespace gotai::geometry::detail {

/// Walks through text and knows the line it is at. Every failure is a FileError with that line.
class TextReader {
 public:
  /// @param comment  from this character to the end of the line is skipped; 0 for none
  TextReader(std::filesystem::path path, std::string_view text, char comment = '\0');

  /// Next word, across lines; empty at the end.
  std::string_view word();
  /// The next word without taking it.
  std::string_view peek();
  /// Next word on the current line; empty at its end.
  std::string_view word_on_line();
  /// The rest of the current line without the line break; moves to the next line.
  std::string_view rest_of_line();
  /// True when only blanks and comments remain.
  bool at_end() { return peek().empty(); }

  /// Next word as a number. Infinite and NaN are accepted here, the geometry is checked later.
  /// @param what  names the number in messages ("a coordinate")
  double real(std::string_view what) { return to_real(required(what), what); }
  std::int64_t integer(std::string_view what) { return to_integer(required(what), what); }
  /// Next word as the number of items that follow. Compared with what the rest of the file can
  /// hold, before anyone allocates.
  /// @param bytes_each  the shortest text (or data) of one item
  std::size_t count(std::string_view what, std::size_t bytes_each);
  /// Fails unless `count` items of `bytes_each` fit into the rest of the text.
  void require_room(std::uint64_t count, std::size_t bytes_each, std::string_view what) const;
  /// Next word, which must be there.
  std::string_view required(std::string_view what);

  double to_real(std::string_view text, std::string_view what) const;
  std::int64_t to_integer(std::string_view text, std::string_view what) const;

  std::size_t line() const { return line_; }
  std::size_t position() const { return position_; }
  /// Continues at a byte further on; lines in between are counted.
  void move_to(std::size_t position);
  std::string_view text() const { return text_; }
  std::size_t remaining() const { return text_.size() - position_; }
  const std::filesystem::path& path() const { return path_; }

  [[noreturn]] void fail(std::string_view reason) const;

 private:
  void skip_blanks(bool across_lines);

  std::filesystem::path path_;
  std::string_view text_;
  std::size_t position_ = 0;
  std::size_t line_ = 1;
  char comment_;
};

/// Reads fixed-size values from bytes; a value that is not there is a FileError.
class BinaryReader {
 public:
  BinaryReader(std::filesystem::path path, std::string_view bytes, std::size_t position = 0,
               std::endian order = std::endian::little)
      : path_(std::move(path)), bytes_(bytes), position_(position), order_(order) {}

  template <typename T>
  T read() {
    static_assert(std::is_arithmetic_v<T>);
    require(sizeof(T));
    char raw[sizeof(T)];
    std::memcpy(raw, bytes_.data() + position_, sizeof(T));
    position_ += sizeof(T);
    if (order_ != std::endian::native)
      for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(raw[i], raw[sizeof(T) - 1 - i]);
    T value;
    std::memcpy(&value, raw, sizeof(T));
    return value;
  }
  /// Fails unless so many bytes are left.
  void require(std::uint64_t bytes) const;
  /// Fails unless `count` items of `bytes_each` are left.
  void require_room(std::uint64_t count, std::size_t bytes_each, std::string_view what) const;
  void skip(std::uint64_t bytes) {
    require(bytes);
    position_ += bytes;
  }
  std::size_t position() const { return position_; }
  std::size_t remaining() const { return bytes_.size() - position_; }
  [[noreturn]] void fail(std::string_view reason) const;

 private:
  std::filesystem::path path_;
  std::string_view bytes_;
  std::size_t position_;
  std::endian order_;
};

/// Lower-case copy (ASCII).
std::string lower(std::string_view text);

}  // namespace gotai::geometry::detail
