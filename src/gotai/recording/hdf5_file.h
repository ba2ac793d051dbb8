/// @file
/// The few things that recordings need of HDF5: tables that grow, fixed arrays, texts. Internal to
/// the module; the only other place that knows HDF5 is transaction_file.cpp.
#pragma once

#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

namespace gotai::recording {

/// Number types of datasets, little-endian on disk.
enum class Scalar : std::uint8_t { u8, u16, u32, u64, f32, f64 };

template <typename T>
constexpr Scalar scalar_of() {
  if constexpr (std::is_same_v<T, std::uint8_t>) return Scalar::u8;
  if constexpr (std::is_same_v<T, std::uint16_t>) return Scalar::u16;
  if constexpr (std::is_same_v<T, std::uint32_t>) return Scalar::u32;
  if constexpr (std::is_same_v<T, std::uint64_t>) return Scalar::u64;
  if constexpr (std::is_same_v<T, float>) return Scalar::f32;
  if constexpr (std::is_same_v<T, double>) return Scalar::f64;
}

using Extents = std::vector<std::uint64_t>;

/// One open HDF5 file. Every function throws FileError naming the file and the dataset.
class Hdf5File {
 public:
  /// A new file, written by all-or-nothing flushes (transaction_file.h).
  /// @throws FileError when it exists already
  static Hdf5File create(const std::string& path);
  /// An existing file for going on writing.
  static Hdf5File append(const std::string& path);
  /// An existing file for reading. An interrupted flush is finished first.
  static Hdf5File read(const std::string& path);
  ~Hdf5File();
  Hdf5File(Hdf5File&& other) noexcept;
  Hdf5File& operator=(Hdf5File&&) = delete;

  const std::string& path() const { return path_; }

  // ---- writing: folders ("groups") on the way are made when missing
  /// An array of fixed size.
  template <typename T>
  void write(const std::string& name, const Extents& extents, const std::vector<T>& values) {
    write_array(name, scalar_of<T>(), extents, values.data());
  }
  void write_text(const std::string& name, const std::string& text);
  /// Rows of texts, cut to `width` bytes.
  void write_texts(const std::string& name, std::size_t width,
                   const std::vector<std::string>& texts);

  /// An empty table whose rows have these extents ({} for numbers).
  /// @param chunk_rows  rows that are stored together
  void create_table(const std::string& name, Scalar scalar, const Extents& row,
                    std::uint64_t chunk_rows);
  void create_text_table(const std::string& name, std::size_t width, std::uint64_t chunk_rows);
  /// Widens the rows of a table with two or more extents; what was not written reads as NaN.
  void set_columns(const std::string& name, std::uint64_t columns);
  /// Appends rows; values.size() must be a multiple of the row's size.
  template <typename T>
  void append_rows(const std::string& name, const std::vector<T>& values) {
    append_values(name, scalar_of<T>(), values.data(), values.size());
  }
  void append_texts(const std::string& name, const std::vector<std::string>& texts);
  /// Changes the number of rows.
  void resize(const std::string& name, std::uint64_t rows);
  /// Replaces a table's content.
  template <typename T>
  void replace_rows(const std::string& name, const std::vector<T>& values) {
    resize(name, 0);
    append_rows(name, values);
  }
  /// Removes a dataset, when it is there.
  void remove(const std::string& name);
  /// Makes everything that was written durable against the end of this process.
  void flush();

  // ---- reading
  bool exists(const std::string& name) const;
  Extents extents(const std::string& name) const;
  /// Rows [begin, begin + count) of a dataset.
  /// @param row  extents that a row must have
  /// @throws FileError also when the dataset has other extents or is larger than the file can hold
  template <typename T>
  std::vector<T> read_rows(const std::string& name, const Extents& row, std::uint64_t begin,
                           std::uint64_t count) const {
    std::vector<T> values(checked_size(name, row, begin, count, sizeof(T)));
    read_values(name, scalar_of<T>(), begin, count, values.data());
    return values;
  }
  /// All rows.
  template <typename T>
  std::vector<T> read_all(const std::string& name, const Extents& row) const {
    const Extents all = extents(name);
    return read_rows<T>(name, row, 0, all.empty() ? 0 : all.front());
  }
  std::string read_text(const std::string& name) const;
  std::vector<std::string> read_texts(const std::string& name) const {
    const Extents all = extents(name);
    return read_text_rows(name, 0, all.empty() ? 0 : all.front());
  }
  std::string read_text_row(const std::string& name, std::uint64_t row) const {
    return read_text_rows(name, row, 1).front();
  }

 private:
  Hdf5File(std::string path, std::int64_t id) : path_(std::move(path)), id_(id) {}

  void write_array(const std::string& name, Scalar scalar, const Extents& extents,
                   const void* values);
  void append_values(const std::string& name, Scalar scalar, const void* values, std::size_t count);
  std::size_t checked_size(const std::string& name, const Extents& row, std::uint64_t begin,
                           std::uint64_t count, std::size_t element) const;
  void read_values(const std::string& name, Scalar scalar, std::uint64_t begin, std::uint64_t count,
                   void* values) const;
  std::vector<std::string> read_text_rows(const std::string& name, std::uint64_t begin,
                                          std::uint64_t count) const;
  [[noreturn]] void fail(const std::string& what) const;

  std::string path_;
  std::int64_t id_;
};

}  // namespace gotai::recording
