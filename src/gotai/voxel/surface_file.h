/// @file
/// The surface model's section of a shape file.
#pragma once

#include "gotai/voxel/byte_stream.h"
#include "gotai/voxel/surface_model.h"

namespace gotai::voxel {

/// Appends the model; an empty one takes four bytes.
void encode_surface(ByteWriter& out, const SurfaceModel& model);

/// Reads what encode_surface wrote and checks every index, so that a search never leaves an array.
/// @throws FileError when the data is impossible
SurfaceModel decode_surface(ByteReader& in);

}  // namespace gotai::voxel
