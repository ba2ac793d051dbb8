/// @file
/// The binary container that carries a run into the page: a JSON header and named arrays.
/// viewer/src/data/container.ts describes the layout and reads it.
#pragma once

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace gotai::view {

/// Collects arrays, then gives the bytes.
class ContainerWriter {
 public:
  /// Adds an array under a name.
  /// @param stride  > 0: stores each element as its difference to the one `stride` places before
  ///                (integers only), which deflates well
  template <typename T>
  void add(const std::string& name, std::span<const T> values, std::size_t stride = 0) {
    nlohmann::json& entry = arrays_[name];
    entry = {{"offset", data_.size()}, {"type", type_name<T>()}, {"count", values.size()}};
    const std::size_t begin = data_.size();
    data_.resize(begin + (values.size_bytes() + 7) / 8 * 8);
    if (!values.empty()) std::memcpy(data_.data() + begin, values.data(), values.size_bytes());
    if constexpr (std::is_integral_v<T>) {
      if (stride == 0) return;
      entry["stride"] = stride;
      for (std::size_t i = stride; i < values.size(); ++i) {
        const T difference = static_cast<T>(values[i] - values[i - stride]);
        std::memcpy(data_.data() + begin + i * sizeof(T), &difference, sizeof(T));
      }
    }
  }
  template <typename T>
  void add(const std::string& name, const std::vector<T>& values, std::size_t stride = 0) {
    add(name, std::span<const T>(values), stride);
  }

  /// Bytes of the arrays so far.
  std::size_t size() const { return data_.size(); }
  /// The container with this header.
  std::vector<std::uint8_t> finish(nlohmann::json header) const;

 private:
  template <typename T>
  static const char* type_name() {
    if constexpr (std::is_same_v<T, std::uint8_t>) return "u8";
    if constexpr (std::is_same_v<T, std::uint16_t>) return "u16";
    if constexpr (std::is_same_v<T, std::int16_t>) return "i16";
    if constexpr (std::is_same_v<T, std::uint32_t>) return "u32";
    if constexpr (std::is_same_v<T, float>) return "f32";
    if constexpr (std::is_same_v<T, double>) return "f64";
  }

  nlohmann::json arrays_ = nlohmann::json::object();
  std::vector<std::uint8_t> data_;
};

}  // namespace gotai::view
