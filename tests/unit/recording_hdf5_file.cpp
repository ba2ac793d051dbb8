// Tables in HDF5 files, and that nothing flushed is lost: killed writers, full disks, damage.
#include "gotai/recording/hdf5_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <random>

#include "gotai/core/error.h"
#include "gotai/recording/transaction_file.h"
#include "support/temporary_folder.h"

namespace gotai::recording {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(Hdf5File, TablesGrowAndShrink) {
  test::TemporaryFolder folder;
  const std::string path = folder.file("a.h5");
  {
    Hdf5File file = Hdf5File::create(path);
    file.create_table("/frames/pose", Scalar::f64, {2, 3}, 4);
    file.append_rows<double>("/frames/pose", {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12});
    file.resize("/frames/pose", 1);
    file.append_rows<double>("/frames/pose", {0, 0, 0, 0, 0, 13});
    file.write_text("/scene/text", "a = 1\n");
    file.create_text_table("/names", 4, 8);
    file.append_texts("/names", {"ab", "longer", ""});
    file.flush();
  }
  const Hdf5File file = Hdf5File::read(path);
  EXPECT_EQ(file.extents("/frames/pose"), (Extents{2, 2, 3}));
  EXPECT_THAT(file.read_rows<double>("/frames/pose", {2, 3}, 1, 1), ElementsAre(0, 0, 0, 0, 0, 13));
  EXPECT_EQ(file.read_text("/scene/text"), "a = 1\n");
  EXPECT_THAT(file.read_texts("/names"), ElementsAre("ab", "long", ""));
  EXPECT_FALSE(file.exists("/frames/no/such"));
  EXPECT_FALSE(std::filesystem::exists(journal_path(path)));
}

TEST(Hdf5File, NewColumnsReadAsNan) {
  test::TemporaryFolder folder;
  Hdf5File file = Hdf5File::create(folder.file("a.h5"));
  file.create_table("/pose", Scalar::f64, {1, 2}, 4);
  file.append_rows<double>("/pose", {1, 2});
  file.set_columns("/pose", 2);
  file.append_rows<double>("/pose", {3, 4, 5, 6});
  const auto values = file.read_all<double>("/pose", {2, 2});
  EXPECT_EQ(values[1], 2.0);
  EXPECT_TRUE(std::isnan(values[2]));
  EXPECT_EQ(values[6], 5.0);
}

// HDF5 1.10 divides by zero when the chunk size of an unchecked structure is damaged.
TEST(Hdf5File, StructuresHaveChecksums) {
  test::TemporaryFolder folder;
  const std::string path = folder.file("a.h5");
  {
    Hdf5File file = Hdf5File::create(path);
    file.create_table("/frames/pose", Scalar::f64, {2, 3}, 4);
  }
  {
    Hdf5File file = Hdf5File::append(path);
    file.append_rows<double>("/frames/pose", std::vector<double>(60, 1.0));
    file.create_table("/late", Scalar::u8, {}, 4);
    file.write_text("/scene/text", "a = 1\n");
  }
  std::ifstream in(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), {});
  EXPECT_EQ(bytes.at(8), 2) << "version 3 cannot be opened after a killed writer";
  EXPECT_THAT(bytes, HasSubstr("OHDR"));
  for (const char* unchecked : {"TREE", "SNOD", "HEAP"})
    EXPECT_EQ(bytes.find(unchecked), std::string::npos) << unchecked;
  // Every byte of the table's description, damaged, is noticed.
  const std::size_t begin = bytes.find("OHDR", bytes.find("OHDR") + 1);
  for (std::size_t at = begin; at < begin + 64; ++at) {
    std::string bad = bytes;
    bad[at] = static_cast<char>(bad[at] ^ 1);
    const std::string damaged = folder.file("damaged.h5");
    std::ofstream(damaged, std::ios::binary) << bad;
    EXPECT_THROW(Hdf5File::read(damaged).read_rows<double>("/frames/pose", {2, 3}, 0, 1), FileError)
        << at - begin;
  }
}

TEST(Hdf5File, AnExistingFileIsNotOverwritten) {
  test::TemporaryFolder folder;
  std::ofstream(folder.file("a.h5")) << "precious";
  try {
    Hdf5File::create(folder.file("a.h5"));
    FAIL();
  } catch (const FileError& error) {
    EXPECT_THAT(error.what(), HasSubstr("exists already"));
  }
  EXPECT_THROW(Hdf5File::create(folder.file("no/such/folder/a.h5")), FileError);
}

TEST(Hdf5File, OneWriterAtATime) {
  test::TemporaryFolder folder;
  const Hdf5File writer = Hdf5File::create(folder.file("a.h5"));
  EXPECT_THROW(Hdf5File::append(folder.file("a.h5")), FileError);
}

TEST(Hdf5File, DamagedFilesAreRefused) {
  test::TemporaryFolder folder;
  const std::string path = folder.file("a.h5");
  EXPECT_THROW(Hdf5File::read(path), FileError) << "missing";
  std::ofstream(path) << "not HDF5 at all";
  EXPECT_THROW(Hdf5File::read(path), FileError);
  std::filesystem::remove(path);
  {
    Hdf5File file = Hdf5File::create(path);
    file.write<double>("/a", {1000}, std::vector<double>(1000, 1.0));
    file.flush();
  }
  const auto size = std::filesystem::file_size(path);
  // The last page may be padding that nobody misses.
  for (std::uintmax_t cut = 0; cut + 4096 < size; cut += size / 16 + 1) {
    const std::string part = folder.file("part.h5");
    std::filesystem::copy_file(path, part, std::filesystem::copy_options::overwrite_existing);
    std::filesystem::resize_file(part, cut);
    EXPECT_THROW(Hdf5File::read(part).read_all<double>("/a", {}), FileError) << cut;
  }
}

TEST(Hdf5File, DeclaredSizesAreComparedWithTheFile) {
  test::TemporaryFolder folder;
  const std::string path = folder.file("a.h5");
  {
    Hdf5File file = Hdf5File::create(path);
    file.create_table("/a", Scalar::f64, {}, 1);
    file.resize("/a", std::uint64_t{1} << 40);  // nothing of it is stored
    file.flush();
  }
  EXPECT_THROW(Hdf5File::read(path).read_all<double>("/a", {}), FileError);
}

// ---- killed writers ----------------------------------------------------------------------------

constexpr std::uint64_t kRows = 50;

/// Writes batches for ever; tells through the pipe how many are flushed.
[[noreturn]] void write_for_ever(const std::string& path, int pipe) {
  Hdf5File file = Hdf5File::create(path);
  file.create_table("/a", Scalar::u64, {}, 16);
  file.create_table("/b", Scalar::f64, {40}, 4);
  file.create_table("/last", Scalar::u64, {}, 1);
  file.flush();
  for (std::uint64_t batch = 0;; ++batch) {
    file.append_rows("/a", std::vector<std::uint64_t>(kRows, batch));
    file.append_rows("/b", std::vector<double>(kRows * 40, static_cast<double>(batch)));
    file.replace_rows("/last", std::vector<std::uint64_t>{batch});
    file.flush();
    if (write(pipe, &batch, sizeof batch) != sizeof batch) _exit(1);
  }
}

TEST(KilledWriter, LosesNothingThatWasFlushed) {
  test::TemporaryFolder folder;
  std::mt19937 random(1);  // NOLINT: the same times in every run
  for (int run = 0; run < 40; ++run) {
    const std::string path = folder.file("run" + std::to_string(run) + ".h5");
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      close(ends[0]);
      write_for_ever(path, ends[1]);
    }
    close(ends[1]);
    std::uint64_t acknowledged = 0;
    ASSERT_EQ(read(ends[0], &acknowledged, sizeof acknowledged), ssize_t{sizeof acknowledged});
    usleep(static_cast<useconds_t>(random() % 20'000));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    while (read(ends[0], &acknowledged, sizeof acknowledged) == sizeof acknowledged) {
    }
    close(ends[0]);

    const Hdf5File file = Hdf5File::read(path);
    const auto a = file.read_all<std::uint64_t>("/a", {});
    const auto b = file.read_all<double>("/b", {40});
    const auto last = file.read_all<std::uint64_t>("/last", {});
    ASSERT_EQ(a.size() % kRows, 0u);
    const std::uint64_t batches = a.size() / kRows;
    ASSERT_GT(batches, acknowledged) << "batches are counted from 0";
    ASSERT_EQ(b.size(), 40 * a.size());
    ASSERT_THAT(last, ElementsAre(batches - 1)) << "a flush is all or nothing";
    for (std::size_t i = 0; i < a.size(); ++i) {
      ASSERT_EQ(a[i], i / kRows);
      ASSERT_EQ(b[40 * i + 7], static_cast<double>(a[i]));
    }
    Hdf5File again = Hdf5File::append(path);
    again.append_rows<std::uint64_t>("/a", {7});
    again.flush();
  }
}

TEST(KilledWriter, AJournalIsFinishedOrDropped) {
  test::TemporaryFolder folder;
  const std::string path = folder.file("a.h5");
  {
    Hdf5File file = Hdf5File::create(path);
    file.write<double>("/a", {3}, {1, 2, 3});
    file.flush();
  }
  std::ofstream(journal_path(path)) << "half a journ";
  EXPECT_THAT(Hdf5File::read(path).read_all<double>("/a", {}), ElementsAre(1, 2, 3));
  EXPECT_FALSE(std::filesystem::exists(journal_path(path)));
}

TEST(KilledWriter, AJournalOfAnotherFileIsNotApplied) {
  test::TemporaryFolder folder;
  const std::string path = folder.file("a.h5");
  std::ofstream(journal_path(path)) << "of a file that was removed";
  {
    Hdf5File file = Hdf5File::create(path);
    EXPECT_EQ(std::filesystem::file_size(journal_path(path)), 0u);
    file.write<double>("/a", {1}, {1});
    file.flush();
  }
  EXPECT_FALSE(std::filesystem::exists(journal_path(path)));
}

TEST(KilledWriter, BeforeTheFirstFlushLeavesAnEmptyFile) {
  test::TemporaryFolder folder;
  std::ofstream(folder.file("a.h5")).flush();
  for (const auto open : {Hdf5File::read, Hdf5File::append}) {
    try {
      open(folder.file("a.h5"));
      FAIL();
    } catch (const FileError& error) {
      EXPECT_THAT(error.what(), HasSubstr("before anything was recorded"));
    }
  }
}

// HDF5 refuses a file shorter than what it allocated: one in four runs killed early left such a
// one.
TEST(KilledWriter, SpaceThatIsNeverWrittenIsInTheFile) {
  test::TemporaryFolder folder;
  const std::string path = folder.file("a.h5");
  const std::string copy = folder.file("copy.h5");
  const hid_t access = make_transaction_access();
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_EXCL, H5P_DEFAULT, access);
  const hsize_t size = 100000;
  const hid_t space = H5Screate_simple(1, &size, nullptr);
  const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_alloc_time(creation, H5D_ALLOC_TIME_EARLY);
  H5Pset_fill_time(creation, H5D_FILL_TIME_NEVER);
  const hid_t dataset =
      H5Dcreate2(file, "/a", H5T_STD_U8LE, space, H5P_DEFAULT, creation, H5P_DEFAULT);
  H5Fflush(file, H5F_SCOPE_GLOBAL);
  std::filesystem::copy_file(path, copy);
  EXPECT_NO_THROW(Hdf5File::read(copy));
  H5Dclose(dataset);
  H5Pclose(creation);
  H5Sclose(space);
  H5Fclose(file);
  H5Pclose(access);
}

// Files cannot grow beyond some bytes while it lives.
class SmallDisk {
 public:
  explicit SmallDisk(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    struct rlimit limit = before_;
    limit.rlim_cur = bytes;
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~SmallDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    signal(SIGXFSZ, old_handler_);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

 private:
  struct rlimit before_ {};
  void (*old_handler_)(int) = signal(SIGXFSZ, SIG_IGN);
};

TEST(FullDisk, TheFirstFlushIsAllOrNothing) {
  test::TemporaryFolder folder;
  const std::string path = folder.file("a.h5");
  {
    Hdf5File file = Hdf5File::create(path);
    file.create_table("/a", Scalar::u64, {}, 1024);
    file.append_rows<std::uint64_t>("/a", std::vector<std::uint64_t>(100000, 1));
    const SmallDisk disk(1 << 18);
    EXPECT_THROW(file.flush(), FileError);
  }
  EXPECT_EQ(std::filesystem::file_size(path), 0U);
}

TEST(FullDisk, KeepsWhatWasFlushed) {
  test::TemporaryFolder folder;
  const std::string path = folder.file("a.h5");
  std::uint64_t flushed = 0;
  std::string message;
  {
    Hdf5File file = Hdf5File::create(path);
    file.create_table("/a", Scalar::u64, {}, 1024);
    file.flush();
    const SmallDisk disk(1 << 20);
    try {
      for (;; ++flushed) {
        file.append_rows("/a", std::vector<std::uint64_t>(5000, flushed));
        file.flush();
      }
    } catch (const FileError& error) {
      message = error.what();
    }
  }
  EXPECT_THAT(message, HasSubstr("File too large"));
  EXPECT_THAT(message, HasSubstr("before the last flush is kept"));
  EXPECT_GT(flushed, 10u);
  const auto a = Hdf5File::read(path).read_all<std::uint64_t>("/a", {});
  ASSERT_EQ(a.size(), 5000 * flushed);
  EXPECT_EQ(a.back(), flushed - 1);
}

}  // namespace
}  // namespace gotai::recording
