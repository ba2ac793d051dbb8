/// @file
/// Prepared shapes kept on disk by the content they are made from, so that the second run of a
/// scene prepares nothing.
#pragma once

#include <filesystem>
#include <string>

#include "gotai/voxel/shape.h"

namespace gotai::voxel {

/// A shape and where it came from.
struct CachedShape {
  Shape shape;
  bool hit = false;     ///< it was read from the cache; nothing was prepared
  std::string warning;  ///< why the cache could not be used or written; empty when all is well
};

/// $GOTAI_CACHE, else $XDG_CACHE_HOME/gotai, else $HOME/.cache/gotai. Empty (no cache) when
/// GOTAI_CACHE is set to nothing or there is no home.
std::filesystem::path default_cache_folder();

/// Reads the shape from the cache, or prepares it with make_shape and stores it. Damaged entries
/// are replaced. A cache that cannot be written is no error: see CachedShape::warning.
/// @param folder  is created when it does not exist; empty: no cache
/// @throws InvalidArgument as make_shape
CachedShape make_shape_cached(std::string name, geometry::Mesh mesh, const ShapeOptions& options,
                              const std::filesystem::path& folder);

/// The file that holds the shape of this content hash.
std::filesystem::path cache_entry(const std::filesystem::path& folder, const Hash128& content);

}  // namespace gotai::voxel
