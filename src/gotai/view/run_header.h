/// @file
/// The part of the viewer's data that does not move: header, meshes and voxels. Internal to view.
#pragma once

#include <nlohmann/json.hpp>

#include "gotai/view/container.h"
#include "gotai/view/run_view.h"

namespace gotai::view {

/// Header of a run as viewer/src/data/run.ts reads it, without frames and contacts. Adds the arrays
/// of meshes and voxels to the container.
/// @param notes  gets a line for everything that was left out
nlohmann::json write_run_header(const RunView& run, ContainerWriter& container,
                                std::vector<std::string>& notes);

}  // namespace gotai::view
