/// @file
/// Content hashes: shape caches are keyed by them, recordings carry one of the state per frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <type_traits>

namespace gotai {

/// A 128-bit hash.
struct Hash128 {
  std::uint64_t low = 0;
  std::uint64_t high = 0;

  friend bool operator==(const Hash128&, const Hash128&) = default;
  /// 32 lower-case hexadecimal digits, high half first.
  std::string hex() const;
};

/// Streaming XXH3-128 over bytes. Hashes the exact bits: -0.0 and 0.0 differ.
class Hasher {
 public:
  Hasher();
  ~Hasher();
  Hasher(const Hasher&) = delete;
  Hasher& operator=(const Hasher&) = delete;

  Hasher& bytes(const void* data, std::size_t size);

  /// Adds the object representation of a value without padding (numbers, enums, Eigen vectors).
  template <typename T>
  Hasher& value(const T& v) {
    static_assert(!std::is_pointer_v<T>);
    return bytes(&v, sizeof(T));
  }
  /// Adds the length, then the elements.
  template <typename T>
  Hasher& array(std::span<const T> values) {
    value(static_cast<std::uint64_t>(values.size()));
    return bytes(values.data(), values.size_bytes());
  }
  Hasher& text(const std::string& s) { return array(std::span<const char>(s.data(), s.size())); }

  Hash128 digest() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gotai
