/// @file
/// What a user says of a body when adding it to a world.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gotai/core/types.h"
#include "gotai/model/body_state.h"

namespace gotai {

/// Pose of a kinematic body's mesh frame at a time. Between frames positions are interpolated
/// linearly, rotations along the great arc; before the first and after the last they hold.
struct KeyFrame {
  double time = 0.0;  ///< [s]
  Pose X_WM;
};

/// A body made of a prepared shape.
struct BodyDescription {
  std::string name;            ///< "" becomes "body N"
  std::uint32_t shape = 0;     ///< from World::add_shape
  std::uint32_t material = 0;  ///< from World::add_material; 0 is the default material
  model::BodyKind kind = model::BodyKind::dynamic;
  Pose X_WM;                             ///< pose of the mesh frame
  std::optional<Vec3> com_position;      ///< [m], W; instead of X_WM.p
  Vec3 velocity = Vec3::Zero();          ///< of the centre of mass [m/s], W
  Vec3 angular_velocity = Vec3::Zero();  ///< [rad/s], W
  std::optional<double> mass;            ///< [kg]; else the density times the volume
  std::optional<double> density;         ///< [kg/m^3]; else the material's
  std::vector<KeyFrame> motion;          ///< kinematic bodies only, ascending times
};

/// A fixed half space.
struct PlaneDescription {
  std::string name;
  Vec3 point = Vec3::Zero();    ///< any point on it [m], W
  Vec3 normal = Vec3::UnitZ();  ///< outward; need not be unit
  std::uint32_t material = 0;
};

/// A fixed open-top box: floor and four walls, solid outwards without end up to the rim.
struct ContainerDescription {
  std::string name;
  Vec3 floor_center = Vec3::Zero();  ///< [m], W
  Vec3 inner = Vec3::Ones();         ///< inner edges x, y and height z [m]
  std::uint32_t material = 0;
};

}  // namespace gotai
