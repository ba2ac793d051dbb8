#include "gotai/voxel/shape_file.h"

#include <gmock/gmock.h>

#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>

#include "gotai/core/error.h"
#include "gotai/geometry/generate.h"
#include "gotai/voxel/shape_cache.h"

namespace gotai::voxel {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::ThrowsMessage;

geometry::Mesh hexapod() {
  geometry::GeneratorOptions options;
  options.shape = "hexapod";
  return geometry::generate(options);
}

void expect_equal(const Shape& a, const Shape& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.content, b.content);
  EXPECT_EQ(a.mesh.vertices, b.mesh.vertices);
  EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
  EXPECT_EQ(a.mesh.tetrahedra, b.mesh.tetrahedra);
  EXPECT_EQ(a.mass.volume, b.mass.volume);
  EXPECT_EQ(a.mass.center_of_mass, b.mass.center_of_mass);
  EXPECT_EQ(a.mass.inertia, b.mass.inertia);
  EXPECT_EQ(a.volume_error, b.volume_error);
  EXPECT_EQ(a.warnings, b.warnings);
  EXPECT_EQ(a.pyramid.grid, b.pyramid.grid);
  ASSERT_EQ(a.pyramid.max_level(), b.pyramid.max_level());
  for (int h = 1; h <= a.pyramid.max_level(); ++h) {
    EXPECT_EQ(a.pyramid.level(h).index, b.pyramid.level(h).index);
    EXPECT_EQ(a.pyramid.level(h).first_child, b.pyramid.level(h).first_child);
  }
  EXPECT_EQ(a.bounding_radius, b.bounding_radius);
  EXPECT_EQ(a.voxel_bounding_radius, b.voxel_bounding_radius);
}

/// A folder of its own for every test, removed afterwards.
class ShapeFile : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ =
        fs::temp_directory_path() / ("gotai-" + std::to_string(::getpid()) + "-" + info->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    path_ = folder_ / "hexapod.gotai-shape";
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string read_bytes() const {
    std::ifstream in(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void write_bytes(const std::string& bytes) const {
    std::ofstream(path_, std::ios::binary | std::ios::trunc) << bytes;
  }
  void expect_refused(const std::string& reason) const {
    EXPECT_THAT([&] { read_shape(path_); },
                ThrowsMessage<FileError>(
                    testing::AllOf(HasSubstr("hexapod.gotai-shape"), HasSubstr(reason))));
  }

  fs::path folder_;
  fs::path path_;
  Shape shape_ = shape_with_warnings();

  static Shape shape_with_warnings() {
    Shape shape = make_shape("hexapod", hexapod(), {.prepared_level = 5});
    shape.volume_error = 0.25;
    shape.warnings = {"one", "two"};
    return shape;
  }
};

TEST_F(ShapeFile, HoldsTheShapeToTheBit) {
  write_shape(path_, shape_);
  EXPECT_TRUE(is_shape_file(path_));
  expect_equal(read_shape(path_), shape_);
  // Nothing but the file is left behind.
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
}

TEST_F(ShapeFile, RefusesOtherFiles) {
  expect_refused("cannot be read");
  EXPECT_FALSE(is_shape_file(path_));
  write_bytes("");
  expect_refused("is no Gotai shape file");
  write_bytes("solid cube\nfacet normal 0 0 1 and so on\n");
  expect_refused("is no Gotai shape file");
  EXPECT_FALSE(is_shape_file(path_));
  EXPECT_THROW(read_shape(folder_), FileError);
}

TEST_F(ShapeFile, RefusesEveryTruncationAndEveryFlippedByte) {
  write_shape(path_, shape_);
  const std::string whole = read_bytes();
  for (std::size_t size = 0; size < whole.size(); size += 1 + size / 8) {
    write_bytes(whole.substr(0, size));
    EXPECT_THROW(read_shape(path_), FileError) << size;
  }
  write_bytes(whole + "x");
  expect_refused("not the announced one");
  for (std::size_t i = 0; i < whole.size(); i += 1 + i / 16) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    write_bytes(damaged);
    EXPECT_THROW(read_shape(path_), FileError) << i;
  }
}

TEST_F(ShapeFile, SaysWhichVersionItIs) {
  write_shape(path_, shape_);
  std::string bytes = read_bytes();
  bytes[8] = 77;
  write_bytes(bytes);
  expect_refused("format version 77");
}

TEST_F(ShapeFile, PayloadsThatPassTheChecksumAreStillChecked) {
  const std::vector<std::byte> good = encode_shape(shape_);
  expect_equal(decode_shape(good, "good"), shape_);
  // Announced sizes far beyond the file must be refused before they are allocated: each number that
  // may be one is tried.
  const std::uint64_t huge = 0x7fffffffffffffff;
  std::size_t tried = 0;
  for (std::size_t at = 0; at + sizeof huge <= good.size(); at += 4) {
    std::uint64_t size = 0;
    std::memcpy(&size, good.data() + at, sizeof size);
    if (size == 0 || size > good.size()) continue;
    ++tried;
    std::vector<std::byte> bad = good;
    std::memcpy(bad.data() + at, &huge, sizeof huge);
    try {
      const Shape shape = decode_shape(bad, "bad");
      // Where the number was no size but part of a value that may be anything.
      EXPECT_EQ(encode_shape(shape), bad) << at;
    } catch (const FileError& refused) {
      EXPECT_THAT(refused.what(), HasSubstr("bad: is ")) << at;
    }
  }
  EXPECT_GT(tried, 10U);
  for (std::size_t size = 0; size < good.size(); size += size < 1000 ? 7 : good.size() / 997)
    EXPECT_THROW(decode_shape(std::span(good).first(size), "short"), FileError);
  std::vector<std::byte> longer = good;
  longer.push_back(std::byte{0});
  EXPECT_THAT([&] { decode_shape(longer, "longer"); },
              ThrowsMessage<FileError>(HasSubstr("goes on after its end")));
}

TEST_F(ShapeFile, SaysWhyItCannotBeWritten) {
  EXPECT_THAT([&] { write_shape(folder_ / "missing" / "a.gotai-shape", shape_); },
              ThrowsMessage<FileError>(HasSubstr("No such file")));
  if (fs::exists("/dev/full")) {
    EXPECT_THROW(write_shape("/dev/full/a", shape_), FileError);
  }
}

using ShapeCache = ShapeFile;

TEST_F(ShapeCache, SecondTimeNothingIsPrepared) {
  const fs::path cache = folder_ / "new" / "cache";
  const CachedShape first = make_shape_cached("one", hexapod(), {.prepared_level = 5}, cache);
  EXPECT_FALSE(first.hit);
  EXPECT_EQ(first.warning, "");
  EXPECT_TRUE(fs::exists(cache_entry(cache, first.shape.content)));
  const CachedShape second = make_shape_cached("two", hexapod(), {.prepared_level = 5}, cache);
  EXPECT_TRUE(second.hit);
  EXPECT_EQ(second.shape.name, "two");
  Shape renamed = second.shape;
  renamed.name = "one";
  expect_equal(renamed, first.shape);
  EXPECT_FALSE(make_shape_cached("other", hexapod(), {.prepared_level = 4}, cache).hit);
}

TEST_F(ShapeCache, DamagedEntriesAreReplaced) {
  const CachedShape first = make_shape_cached("a", hexapod(), {.prepared_level = 4}, folder_);
  path_ = cache_entry(folder_, first.shape.content);
  write_bytes(read_bytes().substr(0, 1000));
  const CachedShape second = make_shape_cached("a", hexapod(), {.prepared_level = 4}, folder_);
  EXPECT_FALSE(second.hit);
  EXPECT_THAT(second.warning, HasSubstr("it was replaced"));
  EXPECT_TRUE(make_shape_cached("a", hexapod(), {.prepared_level = 4}, folder_).hit);
  // An entry under the wrong name is not believed either.
  write_shape(path_, shape_);
  EXPECT_FALSE(make_shape_cached("a", hexapod(), {.prepared_level = 4}, folder_).hit);
}

TEST_F(ShapeCache, WorksWithoutAPlaceToWrite) {
  write_bytes("a file, no folder");
  const CachedShape shape = make_shape_cached("a", hexapod(), {.prepared_level = 3}, path_);
  EXPECT_FALSE(shape.hit);
  EXPECT_NE(shape.warning, "");
  EXPECT_EQ(shape.shape.pyramid.max_level(), 3);
  const CachedShape uncached = make_shape_cached("a", hexapod(), {.prepared_level = 3}, {});
  EXPECT_FALSE(uncached.hit);
  EXPECT_EQ(uncached.warning, "");
}

TEST(CacheFolder, FollowsTheEnvironment) {
  const auto value = [](const char* name) {
    const char* text = std::getenv(name);
    return text == nullptr ? std::string() : std::string(text);
  };
  const std::string home = value("HOME");
  ::setenv("GOTAI_CACHE", "/somewhere", 1);
  EXPECT_EQ(default_cache_folder(), "/somewhere");
  ::setenv("GOTAI_CACHE", "", 1);
  EXPECT_EQ(default_cache_folder(), "");
  ::unsetenv("GOTAI_CACHE");
  ::setenv("XDG_CACHE_HOME", "/xdg", 1);
  EXPECT_EQ(default_cache_folder(), "/xdg/gotai");
  ::unsetenv("XDG_CACHE_HOME");
  ::setenv("HOME", "/home/a", 1);
  EXPECT_EQ(default_cache_folder(), "/home/a/.cache/gotai");
  ::unsetenv("HOME");
  EXPECT_EQ(default_cache_folder(), "");
  if (!home.empty()) ::setenv("HOME", home.c_str(), 1);
}

}  // namespace
}  // namespace gotai::voxel
