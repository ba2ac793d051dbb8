/// @file
/// Recordings for other programs: tables, animated glTF, ParaView.
#pragma once

#include <string>

#include "gotai/recording/recording_reader.h"

namespace gotai::recording {

/// Writes the format that the path's extension names: ".csv", ".glb", ".gltf", ".pvd". The output
/// appears whole or not at all (for ".pvd": the index comes last).
/// @throws FileError for another extension (with the allowed ones), or when it cannot be written
void export_recording(const RecordingReader& recording, const std::string& path);

/// "time,body,px,py,pz,qw,qx,qy,qz": one line per frame and body; times [s], the number of the body
/// in the recording, the pose of its mesh frame [m]. Planes and containers are left out; so are
/// bodies at frames at which they had been removed. Numbers read back exactly.
void export_csv(const RecordingReader& recording, const std::string& path);

/// Animated glTF 2.0: one mesh per shape and material, shared by one node per body; a root node
/// turns z-up into glTF's y-up. Planes and containers become quads. Keys are thinned: at every
/// recorded frame no point of a body is farther than `tolerance` diagonals from its place.
/// @param tolerance  fraction of the diagonal of a body's bounding box
void export_gltf(const RecordingReader& recording, const std::string& path,
                 double tolerance = 5e-4);

/// For ParaView: an index (.pvd) and, in a folder named after it, two VTK files per frame.
/// frame_N.vtp: the polygons of all bodies at their places; point data "velocity" [m/s], cell data
/// "body" and "material". contacts_N.vtp: points with "normal", "impulse" [N s], "gap" [m] and the
/// two bodies.
void export_vtk(const RecordingReader& recording, const std::string& path);

}  // namespace gotai::recording
