/// @file
/// Turning closed surfaces the right way out. Internal to the module.
#pragma once

#include <string>
#include <vector>

#include "gotai/geometry/mesh.h"

namespace gotai::geometry::detail {

/// Treats every patch (triangles joined by edges) whose edges all have exactly two triangles: makes
/// its triangles agree, and turns it outward if it encloses a negative volume and lies in no other
/// closed patch. A patch inside another one may be a cavity and keeps its direction; it is turned
/// only where the surface around it was turned and it would fill what was hollow. Patches that
/// cannot be oriented (one-sided) stay as they are.
void orient_closed_patches(Mesh& mesh, std::vector<std::string>& repairs,
                           std::vector<std::string>& warnings);

}  // namespace gotai::geometry::detail
