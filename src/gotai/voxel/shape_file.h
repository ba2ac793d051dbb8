/// @file
/// Prepared shapes as files [Makino 2007, section 4.4.1: voxel data, polygons and mass properties
/// are saved; the simulation loads them].
///
/// Layout, little-endian: "GOTAISHP", format version (u32), 0, payload size (u64), XXH3-128 of the
/// payload (2 u64), payload. The payload holds name, level, content hash, mesh, mass properties,
/// warnings, grid, the finest level's voxels and the surface model; what follows from them is made
/// anew on reading.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "gotai/voxel/shape.h"

namespace gotai::voxel {

/// The usual extension of shape files.
inline constexpr const char* kShapeFileExtension = ".gotai-shape";

/// Writes a shape. The file appears whole or not at all (written beside it, then renamed).
/// @throws FileError when it cannot be written
void write_shape(const std::filesystem::path& path, const Shape& shape);

/// Reads a shape, equal to the bit to the one written.
/// @throws FileError for a missing, truncated, damaged or foreign file, or another format version
Shape read_shape(const std::filesystem::path& path);

/// Whether a file starts like a shape file. False when it cannot be read.
bool is_shape_file(const std::filesystem::path& path);

/// The payload of a shape file.
std::vector<std::byte> encode_shape(const Shape& shape);
/// Inverse of encode_shape; safe on any bytes. Memory stays within a small multiple of their size.
/// @param path  named in errors
/// @throws FileError when the bytes are no shape
Shape decode_shape(std::span<const std::byte> payload, const std::string& path);

}  // namespace gotai::voxel
