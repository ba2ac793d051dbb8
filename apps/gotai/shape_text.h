/// @file
/// Meshes and prepared shapes described for machines and for people.
#pragma once

#include <nlohmann/json.hpp>

#include "console.h"
#include "gotai/geometry/mesh_report.h"
#include "gotai/voxel/shape.h"

namespace gotai::cli {

nlohmann::ordered_json to_json(const geometry::MeshReport& report);
nlohmann::ordered_json to_json(const voxel::Shape& shape);

void describe(const geometry::MeshReport& mesh, Report& report);
void describe(const voxel::Shape& shape, Report& report);

}  // namespace gotai::cli
