/// @file
/// Names and extents of the datasets of a recording, and what is written once. Internal to the
/// module.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gotai/recording/hdf5_file.h"
#include "gotai/recording/recorder.h"
#include "gotai/world/world.h"

namespace gotai::recording::layout {

inline constexpr const char* kFormat = "gotai recording 1";
inline constexpr std::size_t kNameWidth = 64;
inline constexpr std::size_t kHashWidth = 32;

/// A table of numbers that grows by rows.
struct Table {
  const char* name;
  Scalar scalar;
  Extents row;
  std::uint64_t chunk_rows;
};

/// Tables of /frames and /contacts whose rows have one column per body come from frame_tables.
std::vector<Table> frame_tables(std::uint64_t bodies);
const std::vector<Table>& body_tables();
const std::vector<Table>& contact_tables();
const std::vector<Table>& step_tables();

/// Creates all tables and writes /scene.
void write_start(Hdf5File& file, const World& world, const SceneSource& scene,
                 const RecorderOptions& options);
/// Appends the bodies of these columns to /bodies.
void append_bodies(Hdf5File& file, const World& world,
                   const std::vector<model::BodyIndex>& columns);
/// Writes /shapes/N: polygons, voxels, mass properties.
void write_shape(Hdf5File& file, std::size_t number, const voxel::Shape& shape);

}  // namespace gotai::recording::layout
