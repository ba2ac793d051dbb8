/// @file
/// Normals for drawing. Internal to render.
#pragma once

#include <vector>

#include "gotai/geometry/mesh.h"

namespace gotai::render {

/// One unit normal per corner of every triangle: smooth, except across edges sharper than 32
/// degrees.
std::vector<Eigen::Vector3f> corner_normals(const geometry::Mesh& mesh);

}  // namespace gotai::render
