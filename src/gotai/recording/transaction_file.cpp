#include "gotai/recording/transaction_file.h"

#include <fcntl.h>
#include <hdf5.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <iterator>
#include <map>
#include <memory>
#include <vector>

#include "gotai/core/error.h"
#include "gotai/core/hash.h"

namespace gotai::recording {
namespace {

constexpr std::uint64_t kPage = 4096;
constexpr std::uint64_t kMagic = 0x31306c6e6a746f67;  // "gotjnl01"

using Page = std::array<char, kPage>;
using Pages = std::map<std::uint64_t, Page>;  // by page number

/// Header of a journal: the pages follow, each with its number in front.
struct JournalHeader {
  std::uint64_t magic = kMagic;
  std::uint64_t count = 0;
  Hash128 hash;
};

thread_local std::string failure;
thread_local int held = 0;  // living HeldFlushes

bool fail_with_errno(const char* what) {
  failure = std::string(what) + ": " + std::strerror(errno);
  return false;
}

bool write_all(int fd, const void* data, std::size_t size, std::uint64_t offset) {
  const char* bytes = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t n = pwrite(fd, bytes, size, static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    bytes += n;
    size -= static_cast<std::size_t>(n);
    offset += static_cast<std::uint64_t>(n);
  }
  return true;
}

/// Bytes read before the end of the file; -1 on errors.
ssize_t read_some(int fd, void* data, std::size_t size, std::uint64_t offset) {
  std::size_t done = 0;
  while (done < size) {
    const ssize_t n =
        pread(fd, static_cast<char*>(data) + done, size - done, static_cast<off_t>(offset + done));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return -1;
    if (n == 0) break;
    done += static_cast<std::size_t>(n);
  }
  return static_cast<ssize_t>(done);
}

Hash128 hash_of(const Pages& pages) {
  Hasher hasher;
  for (const auto& [number, page] : pages) hasher.value(number).bytes(page.data(), kPage);
  return hasher.digest();
}

bool write_journal(int fd, const Pages& pages) {
  const JournalHeader header{kMagic, pages.size(), hash_of(pages)};
  std::uint64_t offset = sizeof header;
  for (const auto& [number, page] : pages) {
    if (!write_all(fd, &number, sizeof number, offset)) return false;
    if (!write_all(fd, page.data(), kPage, offset + sizeof number)) return false;
    offset += sizeof number + kPage;
  }
  return write_all(fd, &header, sizeof header, 0);
}

/// The pages of a complete journal; none when it is incomplete.
Pages read_journal(int fd) {
  JournalHeader header;
  struct stat status {};
  if (fstat(fd, &status) != 0) return {};
  if (read_some(fd, &header, sizeof header, 0) != sizeof header || header.magic != kMagic)
    return {};
  const auto size = static_cast<std::uint64_t>(status.st_size);
  if (header.count > size / (kPage + sizeof(std::uint64_t))) return {};
  Pages pages;
  std::uint64_t offset = sizeof header;
  for (std::uint64_t i = 0; i < header.count; ++i) {
    std::uint64_t number = 0;
    if (read_some(fd, &number, sizeof number, offset) != sizeof number) return {};
    if (read_some(fd, pages[number].data(), kPage, offset + sizeof number) != kPage) return {};
    offset += sizeof number + kPage;
  }
  if (pages.size() != header.count || !(hash_of(pages) == header.hash)) return {};
  return pages;
}

bool apply_pages(int fd, const Pages& pages) {
  for (const auto& [number, page] : pages) {
    if (!write_all(fd, page.data(), kPage, number * kPage)) return false;
  }
  return true;
}

struct TransactionFile {
  H5FD_t base{};  // first: HDF5 sees only this part
  std::string path;
  int fd = -1;
  int journal = -1;
  haddr_t allocated = 0;           // "end of allocated addresses" of HDF5
  haddr_t end = 0;                 // of what was written, committed or not
  std::uint64_t stored_pages = 0;  // in the file on disk, all of them written
  Pages pending;
  bool broken = false;  // a flush failed: later writes are dropped
};

TransactionFile& self(H5FD_t* file) { return *reinterpret_cast<TransactionFile*>(file); }
const TransactionFile& self(const H5FD_t* file) {
  return *reinterpret_cast<const TransactionFile*>(file);
}

/// Puts the pages behind the stored ones in their place, where nothing refers to them yet.
bool append_new_pages(TransactionFile& file, std::uint64_t end) {
  const auto first_new = file.pending.lower_bound(file.stored_pages);
  static constexpr Page kZeros{};
  auto next = first_new;
  for (std::uint64_t number = file.stored_pages; number < end; ++number) {
    const bool given = next != file.pending.end() && next->first == number;
    const Page& page = given ? (next++)->second : kZeros;
    if (!write_all(file.fd, page.data(), kPage, number * kPage)) {
      return fail_with_errno("writing failed");
    }
  }
  file.pending.erase(first_new, file.pending.end());
  return true;
}

bool commit(TransactionFile& file) {
  if (file.broken) return false;
  // HDF5 allocates what it never writes, and refuses a file that is shorter than that.
  const std::uint64_t pages = std::max(file.stored_pages, (file.end + kPage - 1) / kPage);
  // Holes are filled: a page that exists can be overwritten on a full disk.
  if (file.stored_pages == 0) {
    // The first pages come through the journal, too: a part of them would be no file.
    for (std::uint64_t number = 0; number < pages; ++number) file.pending.try_emplace(number);
  } else if (!append_new_pages(file, pages)) {
    return false;
  }
  if (!file.pending.empty()) {
    if (!write_journal(file.journal, file.pending)) {
      fail_with_errno("writing the journal failed");
      static_cast<void>(ftruncate(file.journal, 0) == 0);
      return false;
    }
    if (!apply_pages(file.fd, file.pending)) return fail_with_errno("writing failed");
    if (ftruncate(file.journal, 0) != 0) return fail_with_errno("emptying the journal failed");
  }
  file.pending.clear();
  file.stored_pages = pages;
  return true;
}

/// The page for changing: pending, or read from the file.
bool load_page(const TransactionFile& file, std::uint64_t number, Page& page) {
  page.fill(0);
  if (number >= file.stored_pages) return true;
  return read_some(file.fd, page.data(), kPage, number * kPage) >= 0 ||
         fail_with_errno("reading failed");
}

H5FD_t* open_file(const char* name, unsigned flags, hid_t, haddr_t) {
  failure.clear();
  auto file = std::make_unique<TransactionFile>();
  file->path = name;
  int mode = O_RDWR | O_CLOEXEC;
  if ((flags & H5F_ACC_CREAT) != 0) mode |= O_CREAT | O_EXCL;
  file->fd = open(name, mode, 0644);
  if (file->fd < 0) {
    fail_with_errno("opening failed");
    return nullptr;
  }
  file->journal = open(journal_path(name).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  struct stat status {};
  if (file->journal < 0 || flock(file->journal, LOCK_EX | LOCK_NB) != 0 ||
      fstat(file->fd, &status) != 0) {
    fail_with_errno("locking the journal failed");
    if (file->journal >= 0) close(file->journal);
    close(file->fd);
    return nullptr;
  }
  // A journal without its file belongs to one that was removed. (Otherwise recover() ran before.)
  if ((flags & H5F_ACC_CREAT) != 0) static_cast<void>(ftruncate(file->journal, 0) == 0);
  file->end = static_cast<haddr_t>(status.st_size);
  file->stored_pages = (file->end + kPage - 1) / kPage;
  return &file.release()->base;
}

herr_t close_file(H5FD_t* base) {
  const std::unique_ptr<TransactionFile> file(&self(base));
  const bool done = commit(*file);
  close(file->fd);
  // A journal that holds the rest of a failed flush is kept for recover().
  struct stat status {};
  const bool is_empty = fstat(file->journal, &status) == 0 && status.st_size == 0;
  if (is_empty) unlink(journal_path(file->path).c_str());
  close(file->journal);
  return done || file->broken ? 0 : -1;
}

herr_t query_features(const H5FD_t*, unsigned long* flags) {
  *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
           H5FD_FEAT_AGGREGATE_SMALLDATA | H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
  return 0;
}

haddr_t get_allocated(const H5FD_t* file, H5FD_mem_t) { return self(file).allocated; }
herr_t set_allocated(H5FD_t* file, H5FD_mem_t, haddr_t address) {
  self(file).allocated = address;
  return 0;
}
haddr_t get_end(const H5FD_t* file, H5FD_mem_t) { return self(file).end; }

herr_t read_bytes(H5FD_t* base, H5FD_mem_t, hid_t, haddr_t address, std::size_t size, void* out) {
  const TransactionFile& file = self(base);
  char* bytes = static_cast<char*>(out);
  std::memset(bytes, 0, size);
  if (read_some(file.fd, bytes, size, address) < 0) {
    fail_with_errno("reading failed");
    return -1;
  }
  for (auto page = file.pending.lower_bound(address / kPage);
       page != file.pending.end() && page->first * kPage < address + size; ++page) {
    const std::uint64_t begin = std::max<std::uint64_t>(address, page->first * kPage);
    const std::uint64_t end = std::min<std::uint64_t>(address + size, (page->first + 1) * kPage);
    std::memcpy(bytes + (begin - address), page->second.data() + begin % kPage, end - begin);
  }
  return 0;
}

herr_t write_bytes(H5FD_t* base, H5FD_mem_t, hid_t, haddr_t address, std::size_t size,
                   const void* in) {
  TransactionFile& file = self(base);
  if (file.broken) return 0;
  const char* bytes = static_cast<const char*>(in);
  for (std::uint64_t done = 0; done < size;) {
    const std::uint64_t number = (address + done) / kPage;
    const std::uint64_t offset = (address + done) % kPage;
    const std::uint64_t count = std::min<std::uint64_t>(kPage - offset, size - done);
    const auto [page, is_new] = file.pending.try_emplace(number);
    if (is_new && count < kPage && !load_page(file, number, page->second)) return -1;
    std::memcpy(page->second.data() + offset, bytes + done, count);
    done += count;
  }
  file.end = std::max<haddr_t>(file.end, address + size);
  return 0;
}

herr_t flush_file(H5FD_t* base, hid_t, hbool_t) {
  TransactionFile& file = self(base);
  if (file.broken || held > 0) return 0;
  if (commit(file)) return 0;
  file.broken = true;
  file.pending.clear();
  return -1;
}

herr_t truncate_file(H5FD_t* base, hid_t, hbool_t) {
  // The file on disk may be longer than what HDF5 uses; it never shrinks.
  self(base).end = std::max(self(base).end, self(base).allocated);
  return 0;
}

int compare_files(const H5FD_t* a, const H5FD_t* b) { return self(a).path.compare(self(b).path); }

hid_t register_driver() {
  static H5FD_class_t driver = [] {
    H5FD_class_t d{};
    d.name = "gotai_transaction";
    d.maxaddr = HADDR_MAX / 2;
    d.fc_degree = H5F_CLOSE_STRONG;
    d.open = open_file;
    d.close = close_file;
    d.cmp = compare_files;
    d.query = query_features;
    d.get_eoa = get_allocated;
    d.set_eoa = set_allocated;
    d.get_eof = get_end;
    d.read = read_bytes;
    d.write = write_bytes;
    d.flush = flush_file;
    d.truncate = truncate_file;
    const H5FD_mem_t map[] = H5FD_FLMAP_DICHOTOMY;
    std::copy(std::begin(map), std::end(map), std::begin(d.fl_map));
    return d;
  }();
  static const hid_t id = H5FDregister(&driver);
  return id;
}

}  // namespace

std::string journal_path(const std::string& path) { return path + ".journal"; }

bool recover(const std::string& path) {
  const std::string journal_file = journal_path(path);
  const int journal = open(journal_file.c_str(), O_RDWR | O_CLOEXEC);
  if (journal < 0) {
    if (errno == ENOENT) return false;
    throw FileError(journal_file, std::string("cannot be opened: ") + std::strerror(errno));
  }
  if (flock(journal, LOCK_EX | LOCK_NB) != 0) {
    close(journal);
    return true;
  }
  const Pages pages = read_journal(journal);
  bool done = true;
  if (!pages.empty()) {
    const int fd = open(path.c_str(), O_RDWR | O_CLOEXEC);
    done = fd >= 0 && apply_pages(fd, pages);
    if (fd >= 0) close(fd);
  }
  if (done) unlink(journal_file.c_str());
  close(journal);
  if (!done) {
    throw FileError(path, std::string("the last flush could not be finished from its journal: ") +
                              std::strerror(errno));
  }
  return false;
}

std::int64_t make_transaction_access() {
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_driver(access, register_driver(), nullptr);
  H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
  return access;
}

const std::string& transaction_failure() { return failure; }

HeldFlushes::HeldFlushes() { ++held; }
HeldFlushes::~HeldFlushes() { --held; }

}  // namespace gotai::recording
