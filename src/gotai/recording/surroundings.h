/// @file
/// Planes and containers as polygons, for exports. Internal to the module.
#pragma once

#include "gotai/geometry/mesh.h"
#include "gotai/recording/recording_reader.h"

namespace gotai::recording {

/// A square in the plane z = 0 with this half edge [m].
geometry::Mesh plane_square(double half_edge);
/// Floor and walls of a container, seen from inside.
/// @param half_extent  inner half edges x, y and the height [m]
geometry::Mesh container_walls(const Vec3& half_extent);

/// Half edge of a square on which all bodies of all frames lie [m].
double plane_half_edge(const RecordingReader& recording);

/// What a body looks like: its shape's polygons, a square for a plane, walls for a container.
geometry::Mesh drawing_of(const RecordingReader& recording, std::size_t body, double plane_edge);

}  // namespace gotai::recording
