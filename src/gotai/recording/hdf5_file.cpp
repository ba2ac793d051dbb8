#include "gotai/recording/hdf5_file.h"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <utility>

#include "gotai/core/error.h"
#include "gotai/recording/transaction_file.h"

namespace gotai::recording {
namespace {

/// Owns an HDF5 identifier.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(Handle&& other) noexcept
      : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Handle& operator=(Handle&&) = delete;
  operator hid_t() const { return id_; }  // NOLINT(google-explicit-constructor)
  bool is_valid() const { return id_ >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

hid_t type_of(Scalar scalar) {
  switch (scalar) {
    case Scalar::u8:
      return H5T_STD_U8LE;
    case Scalar::u16:
      return H5T_STD_U16LE;
    case Scalar::u32:
      return H5T_STD_U32LE;
    case Scalar::u64:
      return H5T_STD_U64LE;
    case Scalar::f32:
      return H5T_IEEE_F32LE;
    case Scalar::f64:
      return H5T_IEEE_F64LE;
  }
  return H5I_INVALID_HID;
}

Handle text_type(std::size_t width) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, std::max<std::size_t>(width, 1));
  H5Tset_cset(type, H5T_CSET_UTF8);
  return type;
}

std::vector<hsize_t> to_hsize(const Extents& extents) { return {extents.begin(), extents.end()}; }

/// HDF5 prints to standard error by default; our exceptions say it.
void silence() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

Handle open_dataset(hid_t file, const std::string& name) {
  return {H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose};
}

Handle creation_with_folders() {
  Handle creation(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(creation, 1);
  return creation;
}

std::vector<char> padded(const std::vector<std::string>& texts, std::size_t width) {
  std::vector<char> bytes(texts.size() * width, '\0');
  for (std::size_t i = 0; i < texts.size(); ++i) {
    std::copy_n(texts[i].begin(), std::min(width, texts[i].size()),
                bytes.begin() + static_cast<std::ptrdiff_t>(i * width));
  }
  return bytes;
}

/// Creates a table that can grow in every direction.
bool make_table(hid_t file, const std::string& name, hid_t type, std::vector<hsize_t> extents,
                std::uint64_t chunk_rows, bool nan_fill) {
  std::vector<hsize_t> chunk = extents;
  chunk.front() = chunk_rows;
  for (hsize_t& extent : chunk) extent = std::max<hsize_t>(extent, 1);
  const std::vector<hsize_t> unlimited(extents.size(), H5S_UNLIMITED);
  const Handle space(
      H5Screate_simple(static_cast<int>(extents.size()), extents.data(), unlimited.data()),
      H5Sclose);
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_chunk(creation, static_cast<int>(chunk.size()), chunk.data());
  if (nan_fill) {
    const double fill = std::numeric_limits<double>::quiet_NaN();
    H5Pset_fill_value(creation, H5T_NATIVE_DOUBLE, &fill);
  }
  const Handle links = creation_with_folders();
  return Handle(H5Dcreate2(file, name.c_str(), type, space, links, creation, H5P_DEFAULT), H5Dclose)
      .is_valid();
}

/// Writes rows behind the last one.
bool append(hid_t dataset, hid_t type, const void* values, std::size_t rows) {
  const Handle space(H5Dget_space(dataset), H5Sclose);
  std::vector<hsize_t> extents(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
  H5Sget_simple_extent_dims(space, extents.data(), nullptr);
  std::vector<hsize_t> start(extents.size(), 0);
  start.front() = extents.front();
  extents.front() += rows;
  if (H5Dset_extent(dataset, extents.data()) < 0) return false;
  const Handle target(H5Dget_space(dataset), H5Sclose);
  extents.front() = rows;
  H5Sselect_hyperslab(target, H5S_SELECT_SET, start.data(), nullptr, extents.data(), nullptr);
  const Handle source(H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr),
                      H5Sclose);
  return H5Dwrite(dataset, type, source, target, H5P_DEFAULT, values) >= 0;
}

/// Reads rows from `begin` on; `sizes` are the extents of what is read.
bool read_hyperslab(hid_t dataset, hid_t type, std::uint64_t begin,
                    const std::vector<hsize_t>& sizes, void* out) {
  if (std::find(sizes.begin(), sizes.end(), 0) != sizes.end()) return true;
  const Handle source(H5Dget_space(dataset), H5Sclose);
  std::vector<hsize_t> start(sizes.size(), 0);
  start.front() = begin;
  H5Sselect_hyperslab(source, H5S_SELECT_SET, start.data(), nullptr, sizes.data(), nullptr);
  const Handle target(H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), nullptr),
                      H5Sclose);
  return H5Dread(dataset, type, target, source, H5P_DEFAULT, out) >= 0;
}

/// A file whose writer was killed before its first flush.
void require_content(const std::string& path) {
  std::error_code error;
  if (std::filesystem::file_size(path, error) > 0 || error) return;
  throw FileError(path,
                  "is empty: its run ended before anything was recorded; remove it and start anew");
}

/// HDF5's older structures have no checksums, and damaged ones can crash it.
void write_with_checksums(hid_t file) {
  const HeldFlushes held;  // the call flushes, but nothing is recorded yet
  H5Fset_libver_bounds(file, H5F_LIBVER_V110, H5F_LIBVER_V110);
}

std::string failure_text(const std::string& fallback) {
  return transaction_failure().empty() ? fallback : transaction_failure();
}

}  // namespace

Hdf5File Hdf5File::create(const std::string& path) {
  silence();
  std::error_code error;
  if (std::filesystem::exists(path, error)) {
    throw FileError(path, "exists already; remove it, choose another name, or resume it");
  }
  const Handle access(make_transaction_access(), H5Pclose);
  // Not newer: the next superblock refuses to be opened after a killed writer.
  H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V18);
  const hid_t id = H5Fcreate(path.c_str(), H5F_ACC_EXCL, H5P_DEFAULT, access);
  if (id < 0) throw FileError(path, "cannot be created: " + failure_text("unknown reason"));
  write_with_checksums(id);
  return {path, id};
}

Hdf5File Hdf5File::append(const std::string& path) {
  silence();
  if (!std::filesystem::exists(path)) throw FileError(path, "does not exist");
  if (recover(path)) throw FileError(path, "is being written by another process");
  require_content(path);
  const Handle access(make_transaction_access(), H5Pclose);
  const hid_t id = H5Fopen(path.c_str(), H5F_ACC_RDWR, access);
  if (id < 0)
    throw FileError(path, "cannot be opened for writing: " + failure_text("no recording"));
  write_with_checksums(id);
  return {path, id};
}

Hdf5File Hdf5File::read(const std::string& path) {
  silence();
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw FileError(path, "does not exist");
  recover(path);
  require_content(path);
  const hid_t id = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (id < 0) throw FileError(path, "is no HDF5 file, or is damaged");
  return {path, id};
}

Hdf5File::Hdf5File(Hdf5File&& other) noexcept
    : path_(std::move(other.path_)), id_(std::exchange(other.id_, H5I_INVALID_HID)) {}

Hdf5File::~Hdf5File() {
  if (id_ >= 0) H5Fclose(id_);
}

void Hdf5File::fail(const std::string& what) const { throw FileError(path_, what); }

void Hdf5File::write_array(const std::string& name, Scalar scalar, const Extents& extents,
                           const void* values) {
  const std::vector<hsize_t> sizes = to_hsize(extents);
  const Handle space(H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), nullptr),
                     H5Sclose);
  const Handle links = creation_with_folders();
  const Handle dataset(
      H5Dcreate2(id_, name.c_str(), type_of(scalar), space, links, H5P_DEFAULT, H5P_DEFAULT),
      H5Dclose);
  if (!dataset.is_valid() ||
      H5Dwrite(dataset, type_of(scalar), H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0) {
    fail(failure_text("dataset " + name + " cannot be written"));
  }
}

void Hdf5File::write_texts(const std::string& name, std::size_t width,
                           const std::vector<std::string>& texts) {
  create_text_table(name, width, std::max<std::uint64_t>(1, texts.size()));
  append_texts(name, texts);
}

void Hdf5File::write_text(const std::string& name, const std::string& text) {
  const Handle type = text_type(text.size());
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle links = creation_with_folders();
  const Handle dataset(H5Dcreate2(id_, name.c_str(), type, space, links, H5P_DEFAULT, H5P_DEFAULT),
                       H5Dclose);
  if (!dataset.is_valid() ||
      H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str()) < 0) {
    fail(failure_text("text " + name + " cannot be written"));
  }
}

void Hdf5File::create_table(const std::string& name, Scalar scalar, const Extents& row,
                            std::uint64_t chunk_rows) {
  std::vector<hsize_t> extents = {0};
  extents.insert(extents.end(), row.begin(), row.end());
  const bool real = scalar == Scalar::f32 || scalar == Scalar::f64;
  if (!make_table(id_, name, type_of(scalar), extents, chunk_rows, real)) {
    fail(failure_text("table " + name + " cannot be created"));
  }
}

void Hdf5File::create_text_table(const std::string& name, std::size_t width,
                                 std::uint64_t chunk_rows) {
  if (!make_table(id_, name, text_type(width), {0}, chunk_rows, false)) {
    fail(failure_text("table " + name + " cannot be created"));
  }
}

void Hdf5File::append_values(const std::string& name, Scalar scalar, const void* values,
                             std::size_t count) {
  if (count == 0) return;
  std::size_t row = 1;
  const Extents all = extents(name);
  for (std::size_t i = 1; i < all.size(); ++i) row *= all[i];
  if (row == 0 || count % row != 0) fail(fmt::format("{} values are no rows of {}", count, name));
  const Handle dataset = open_dataset(id_, name);
  if (!dataset.is_valid() || !recording::append(dataset, type_of(scalar), values, count / row)) {
    fail(failure_text("table " + name + " cannot be written"));
  }
}

void Hdf5File::append_texts(const std::string& name, const std::vector<std::string>& texts) {
  if (texts.empty()) return;
  const Handle dataset = open_dataset(id_, name);
  if (!dataset.is_valid()) fail("has no table " + name);
  const Handle type(H5Dget_type(dataset), H5Tclose);
  const std::vector<char> bytes = padded(texts, H5Tget_size(type));
  if (!recording::append(dataset, type, bytes.data(), texts.size())) {
    fail(failure_text("table " + name + " cannot be written"));
  }
}

void Hdf5File::resize(const std::string& name, std::uint64_t rows) {
  std::vector<hsize_t> sizes = to_hsize(extents(name));
  const Handle dataset = open_dataset(id_, name);
  if (sizes.empty()) fail("has no table " + name);
  sizes.front() = rows;
  if (H5Dset_extent(dataset, sizes.data()) < 0) fail("table " + name + " cannot be resized");
}

void Hdf5File::set_columns(const std::string& name, std::uint64_t columns) {
  std::vector<hsize_t> sizes = to_hsize(extents(name));
  const Handle dataset = open_dataset(id_, name);
  if (sizes.size() < 2) fail("has no table " + name + " with columns");
  sizes[1] = columns;
  if (H5Dset_extent(dataset, sizes.data()) < 0) fail("table " + name + " cannot be widened");
}

void Hdf5File::remove(const std::string& name) {
  if (exists(name)) H5Ldelete(id_, name.c_str(), H5P_DEFAULT);
}

void Hdf5File::flush() {
  if (H5Fflush(id_, H5F_SCOPE_GLOBAL) < 0) {
    fail(failure_text("cannot be written") + "; everything before the last flush is kept");
  }
}

bool Hdf5File::exists(const std::string& name) const {
  for (std::size_t slash = name.find('/', 1);; slash = name.find('/', slash + 1)) {
    if (H5Lexists(id_, name.substr(0, slash).c_str(), H5P_DEFAULT) <= 0) return false;
    if (slash == std::string::npos) return true;
  }
}

Extents Hdf5File::extents(const std::string& name) const {
  if (!exists(name)) fail("has no dataset " + name + "; it is no recording, or it is damaged");
  const Handle dataset = open_dataset(id_, name);
  if (!dataset.is_valid()) fail("dataset " + name + " is damaged");
  const Handle space(H5Dget_space(dataset), H5Sclose);
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank < 0) fail("dataset " + name + " is damaged");
  std::vector<hsize_t> sizes(static_cast<std::size_t>(rank));
  H5Sget_simple_extent_dims(space, sizes.data(), nullptr);
  return {sizes.begin(), sizes.end()};
}

std::size_t Hdf5File::checked_size(const std::string& name, const Extents& row, std::uint64_t begin,
                                   std::uint64_t count, std::size_t element) const {
  const Extents all = extents(name);
  if (all.size() != row.size() + 1 || !std::equal(row.begin(), row.end(), all.begin() + 1)) {
    fail(fmt::format("dataset {} has the wrong extents", name));
  }
  if (begin > all.front() || count > all.front() - begin) {
    fail(fmt::format("dataset {} has {} rows, fewer than {}", name, all.front(), begin + count));
  }
  // Declared sizes are compared with the file's before anything is allocated.
  constexpr std::uint64_t kSlack = 64u << 20;  // unwritten parts take no room in the file
  std::error_code error;
  const std::uint64_t most = (std::filesystem::file_size(path_, error) + kSlack) / element;
  std::uint64_t size = count;
  for (const std::uint64_t extent : row) {
    if (extent != 0 && size > most / extent) {
      fail(fmt::format("dataset {} claims to be larger than the file", name));
    }
    size *= extent;
  }
  if (error || size > most) fail(fmt::format("dataset {} claims to be larger than the file", name));
  return static_cast<std::size_t>(size);
}

void Hdf5File::read_values(const std::string& name, Scalar scalar, std::uint64_t begin,
                           std::uint64_t count, void* values) const {
  const Handle dataset = open_dataset(id_, name);
  std::vector<hsize_t> sizes = to_hsize(extents(name));
  sizes.front() = count;
  if (!read_hyperslab(dataset, type_of(scalar), begin, sizes, values)) {
    fail("dataset " + name + " cannot be read");
  }
}

std::string Hdf5File::read_text(const std::string& name) const {
  constexpr std::size_t kLargest = 256u << 20;
  extents(name);
  const Handle dataset = open_dataset(id_, name);
  const Handle type(H5Dget_type(dataset), H5Tclose);
  const std::size_t size = H5Tget_size(type);
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0 || size > kLargest ||
      H5Dget_storage_size(dataset) != size) {
    fail("dataset " + name + " is no text");
  }
  std::string text(size, '\0');
  if (H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()) < 0) {
    fail("text " + name + " cannot be read");
  }
  while (!text.empty() && text.back() == '\0') text.pop_back();
  return text;
}

std::vector<std::string> Hdf5File::read_text_rows(const std::string& name, std::uint64_t begin,
                                                  std::uint64_t count) const {
  extents(name);
  const Handle dataset = open_dataset(id_, name);
  const Handle type(H5Dget_type(dataset), H5Tclose);
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0) {
    fail("dataset " + name + " is no list of texts");
  }
  const std::size_t width = H5Tget_size(type);
  std::vector<char> bytes(checked_size(name, {}, begin, count, width) * width);
  if (!read_hyperslab(dataset, type, begin, {count}, bytes.data())) {
    fail("texts " + name + " cannot be read");
  }
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < count; ++i) {
    const char* first = bytes.data() + i * width;
    texts.emplace_back(first, std::find(first, first + width, '\0'));
  }
  return texts;
}

}  // namespace gotai::recording
