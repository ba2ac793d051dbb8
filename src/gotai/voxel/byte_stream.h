/// @file
/// Numbers and arrays to and from bytes, little-endian. Reading never goes beyond the end and never
/// allocates more than the bytes at hand can fill.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "gotai/core/error.h"

namespace gotai::voxel {

static_assert(std::endian::native == std::endian::little,
              "shape files are written as they lie in memory");

/// Types without padding or pointers whose memory may be copied: numbers, arrays of them, Eigen
/// vectors and matrices of fixed size.
template <typename T>
concept PlainBytes = !std::is_pointer_v<T> && std::is_trivially_destructible_v<T>;

/// Appends to a byte array.
class ByteWriter {
 public:
  void bytes(const void* data, std::size_t size) {
    const std::size_t at = bytes_.size();
    bytes_.resize(at + size);
    if (size > 0) std::memcpy(bytes_.data() + at, data, size);
  }
  template <PlainBytes T>
  void value(const T& v) {
    bytes(&v, sizeof(T));
  }
  /// The length as 64 bits, then the elements.
  template <PlainBytes T>
  void array(std::span<const T> values) {
    value(static_cast<std::uint64_t>(values.size()));
    bytes(values.data(), values.size_bytes());
  }
  template <PlainBytes T>
  void array(const std::vector<T>& values) {
    array(std::span<const T>(values));
  }
  void text(const std::string& s) { array(std::span<const char>(s.data(), s.size())); }

  const std::vector<std::byte>& data() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

/// Reads what ByteWriter wrote.
class ByteReader {
 public:
  /// @param path  named in errors
  ByteReader(std::span<const std::byte> bytes, std::string path)
      : bytes_(bytes), path_(std::move(path)) {}

  std::size_t remaining() const { return bytes_.size(); }
  const std::string& path() const { return path_; }

  /// @throws FileError beyond the end
  template <PlainBytes T>
  T value() {
    T v;
    take(&v, sizeof(T));
    return v;
  }
  /// @throws FileError when the announced length does not fit into the rest
  template <PlainBytes T>
  std::vector<T> array() {
    std::vector<T> values(count(sizeof(T)));
    take(values.data(), values.size() * sizeof(T));
    return values;
  }
  std::string text() {
    std::string s(count(1), '\0');
    take(s.data(), s.size());
    return s;
  }
  /// @throws FileError with this reason
  [[noreturn]] void fail(const std::string& reason) const { throw FileError(path_, reason); }

 private:
  std::size_t count(std::size_t element_size) {
    const auto n = value<std::uint64_t>();
    if (n > bytes_.size() / element_size) fail("is truncated or damaged: an array is too long");
    return static_cast<std::size_t>(n);
  }
  void take(void* out, std::size_t size) {
    if (size > bytes_.size()) fail("is truncated or damaged: it ends too early");
    if (size > 0) std::memcpy(out, bytes_.data(), size);
    bytes_ = bytes_.subspan(size);
  }

  std::span<const std::byte> bytes_;
  std::string path_;
};

}  // namespace gotai::voxel
