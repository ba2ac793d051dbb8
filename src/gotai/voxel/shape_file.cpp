#include "gotai/voxel/shape_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <system_error>

#include "gotai/core/error.h"
#include "gotai/core/hash.h"
#include "gotai/voxel/byte_stream.h"
#include "gotai/voxel/surface_file.h"

namespace gotai::voxel {
namespace {

constexpr std::array<char, 8> kMagic{'G', 'O', 'T', 'A', 'I', 'S', 'H', 'P'};
constexpr std::uint32_t kFormatVersion = 6;

struct Header {
  std::array<char, 8> magic = kMagic;
  std::uint32_t version = kFormatVersion;
  std::uint32_t zero = 0;
  std::uint64_t payload_size = 0;
  Hash128 checksum;
};
static_assert(sizeof(Header) == 40);

Hash128 checksum(std::span<const std::byte> payload) {
  return Hasher().bytes(payload.data(), payload.size()).digest();
}

template <typename Simplex>
std::vector<Simplex> decode_simplices(ByteReader& in, std::size_t vertices) {
  auto simplices = in.array<Simplex>();
  for (const Simplex& s : simplices)
    if (std::any_of(s.begin(), s.end(), [&](std::uint32_t v) { return v >= vertices; }))
      in.fail("is damaged: the mesh names a vertex that does not exist");
  return simplices;
}

geometry::Mesh decode_mesh(ByteReader& in) {
  geometry::Mesh mesh;
  mesh.vertices = in.array<Vec3>();
  if (!std::all_of(mesh.vertices.begin(), mesh.vertices.end(),
                   [](const Vec3& v) { return v.allFinite(); }))
    in.fail("is damaged: a vertex is not finite");
  mesh.triangles = decode_simplices<geometry::Triangle>(in, mesh.vertices.size());
  mesh.tetrahedra = decode_simplices<geometry::Tetrahedron>(in, mesh.vertices.size());
  return mesh;
}

geometry::MassProperties decode_mass(ByteReader& in) {
  geometry::MassProperties mass;
  mass.volume = in.value<double>();
  mass.center_of_mass = in.value<Vec3>();
  mass.inertia = in.value<Mat3>();
  const bool positive = mass.volume > 0.0 && (mass.inertia.diagonal().array() > 0.0).all();
  if (!positive || !std::isfinite(mass.volume) || !mass.center_of_mass.allFinite() ||
      !mass.inertia.allFinite() || mass.inertia != mass.inertia.transpose())
    in.fail("is damaged: impossible mass properties");
  return mass;
}

std::vector<std::string> decode_warnings(ByteReader& in) {
  std::vector<std::string> warnings;
  // Every text takes at least its length, so that a false count ends with the bytes.
  for (auto left = in.value<std::uint64_t>(); left > 0; --left) warnings.push_back(in.text());
  return warnings;
}

Pyramid decode_pyramid(ByteReader& in, int max_level) {
  VoxelGrid grid;
  grid.origin = in.value<Vec3>();
  grid.edge = in.value<double>();
  if (!grid.origin.allFinite() || !std::isfinite(grid.edge) || !(grid.edge > 0.0))
    in.fail("is damaged: impossible voxel grid");
  auto surface = in.array<VoxelIndex>();
  if (surface.empty()) in.fail("is damaged: it has no voxels");
  const int side = 1 << (max_level - 1);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    for (const std::uint16_t k : surface[i])
      if (k >= side) in.fail("is damaged: a voxel lies outside of the grid");
    if (i > 0 && morton_code(surface[i - 1]) >= morton_code(surface[i]))
      in.fail("is damaged: the voxels are not in order");
  }
  return pyramid_from_surface(grid, max_level, std::move(surface));
}

/// Writes header and payload; returns what went wrong, or nothing.
std::string write_bytes(const std::filesystem::path& path, std::span<const std::byte> payload) {
  Header header;
  header.payload_size = payload.size();
  header.checksum = checksum(payload);
  errno = 0;
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) return std::strerror(errno);
  bool written = std::fwrite(&header, sizeof header, 1, file) == 1;
  written = written && std::fwrite(payload.data(), 1, payload.size(), file) == payload.size();
  std::string reason = written ? "" : std::strerror(errno);
  if (std::fclose(file) != 0 && reason.empty()) reason = std::strerror(errno);
  return reason;
}

}  // namespace

std::vector<std::byte> encode_shape(const Shape& shape) {
  ByteWriter out;
  out.text(shape.name);
  out.value(static_cast<std::int32_t>(shape.pyramid.max_level()));
  out.value(shape.content);
  out.array(shape.mesh.vertices);
  out.array(shape.mesh.triangles);
  out.array(shape.mesh.tetrahedra);
  out.value(shape.mass.volume);
  out.value(shape.mass.center_of_mass);
  out.value(shape.mass.inertia);
  out.value(shape.volume_error);
  out.value(static_cast<std::uint64_t>(shape.warnings.size()));
  for (const std::string& warning : shape.warnings) out.text(warning);
  out.value(shape.pyramid.grid.origin);
  out.value(shape.pyramid.grid.edge);
  out.array(shape.pyramid.levels.back().index);
  encode_surface(out, shape.surface);
  return out.data();
}

Shape decode_shape(std::span<const std::byte> payload, const std::string& path) {
  ByteReader in(payload, path);
  Shape shape;
  shape.name = in.text();
  const auto max_level = in.value<std::int32_t>();
  if (max_level < 1 || max_level > kMaxLevel)
    in.fail(fmt::format("is damaged: level {}, must be 1..{}", max_level, kMaxLevel));
  shape.content = in.value<Hash128>();
  shape.mesh = decode_mesh(in);
  shape.mass = decode_mass(in);
  shape.volume_error = in.value<double>();
  shape.warnings = decode_warnings(in);
  shape.pyramid = decode_pyramid(in, max_level);
  shape.surface = decode_surface(in);
  if (in.remaining() > 0) in.fail("is damaged: it goes on after its end");
  derive_radii(shape);
  return shape;
}

void write_shape(const std::filesystem::path& path, const Shape& shape) {
  // Two processes may write the same entry of a cache at once.
  std::filesystem::path unfinished = path;
  unfinished += fmt::format(".{}.part", ::getpid());
  std::string reason = write_bytes(unfinished, encode_shape(shape));
  std::error_code error;
  if (reason.empty()) {
    std::filesystem::rename(unfinished, path, error);
    if (!error) return;
    reason = error.message();
  }
  std::filesystem::remove(unfinished, error);
  throw FileError(path.string(), "cannot be written: " + reason);
}

Shape read_shape(const std::filesystem::path& path) {
  std::error_code error;
  const std::uintmax_t file_size = std::filesystem::file_size(path, error);
  if (error) throw FileError(path.string(), "cannot be read: " + error.message());
  std::ifstream in(path, std::ios::binary);
  Header header;
  if (!in.read(reinterpret_cast<char*>(&header), sizeof header) || header.magic != kMagic)
    throw FileError(path.string(), "is no Gotai shape file");
  if (header.version != kFormatVersion)
    throw FileError(path.string(),
                    fmt::format("has format version {}, this Gotai reads {}; prepare the shape "
                                "again from its mesh",
                                header.version, kFormatVersion));
  if (header.zero != 0 || header.payload_size != file_size - sizeof header)
    throw FileError(path.string(), "is truncated or damaged: its size is not the announced one");
  std::vector<std::byte> payload(header.payload_size);
  if (!in.read(reinterpret_cast<char*>(payload.data()),
               static_cast<std::streamsize>(payload.size())))
    throw FileError(path.string(), "cannot be read to its end");
  if (checksum(payload) != header.checksum)
    throw FileError(path.string(), "is damaged: its checksum is wrong");
  return decode_shape(payload, path.string());
}

bool is_shape_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::array<char, 8> magic{};
  return in.read(magic.data(), magic.size()) && magic == kMagic;
}

}  // namespace gotai::voxel
