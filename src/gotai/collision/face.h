/// @file
/// The faces of planes and containers that bodies rest on.
#pragma once

#include <array>

#include "gotai/core/types.h"

namespace gotai::collision {

/// A half space in the frame of its body U: the height of a point above its face is
/// normal . p_U + offset [m].
struct Face {
  Vec3 normal;    ///< unit, in U, out of the material
  double offset;  ///< [m]
};

/// The face of a plane and the floor of a container.
inline Face floor_face() { return {Vec3::UnitZ(), 0.0}; }

/// The inner walls of an open-top box.
/// @param half_extent  half of its edges [m]
inline std::array<Face, 4> container_walls(const Vec3& half_extent) {
  return {{{Vec3::UnitX(), half_extent.x()},
           {-Vec3::UnitX(), half_extent.x()},
           {Vec3::UnitY(), half_extent.y()},
           {-Vec3::UnitY(), half_extent.y()}}};
}

}  // namespace gotai::collision
