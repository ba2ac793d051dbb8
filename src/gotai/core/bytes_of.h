/// @file
/// What arrays take of memory.
#pragma once

#include <cstddef>
#include <vector>

namespace gotai {

/// Bytes on the heap of an array of plain values, room that it does not use included.
template <typename T>
std::size_t bytes_of(const std::vector<T>& values) {
  return values.capacity() * sizeof(T);
}

/// The same of arrays of arrays.
template <typename T>
std::size_t bytes_of(const std::vector<std::vector<T>>& rows) {
  std::size_t total = rows.capacity() * sizeof(std::vector<T>);
  for (const std::vector<T>& row : rows) total += bytes_of(row);
  return total;
}

}  // namespace gotai
