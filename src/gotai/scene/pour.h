/// @file
/// Seeded places for many bodies, none of which touches anything at the start.
#pragma once

#include <array>
#include <map>
#include <vector>

#include "gotai/core/types.h"
#include "gotai/scene/description.h"
#include "gotai/world/world.h"

namespace gotai::scene {

/// Balls that must not overlap, found by place. Cells of a uniform grid as wide as the largest
/// ball.
class BallSet {
 public:
  /// @param largest_radius  of all balls that will be added or asked for [m]
  explicit BallSet(double largest_radius);

  void add(const Vec3& center, double radius);
  /// Does a ball overlap one of the set?
  bool overlaps(const Vec3& center, double radius) const;

 private:
  using Cell = std::array<std::int64_t, 3>;
  struct Ball {
    Vec3 center;
    double radius;
  };
  Cell cell_of(const Vec3& point) const;

  double cell_edge_;
  std::map<Cell, std::vector<Ball>> cells_;
};

/// One body of a pour: which of Pour::shapes, where its centre of mass is, how it is turned.
struct PouredBody {
  std::uint32_t shape = 0;
  Vec3 com_position = Vec3::Zero();  ///< [m], W
  Quat rotation = Quat::Identity();
};

/// Radius of the ball around a shape's centre of mass that holds everything that can touch, for the
/// collision settings in use [m].
double contact_radius(const voxel::Shape& shape, const model::CollisionSettings& settings);

/// Draws places by rejection: a place is taken when the body's contact ball overlaps no plane, no
/// container wall, no ball of `occupied`, and no voxel of the world's fixed and kinematic shapes.
/// @param world            planes, containers and all single bodies; unchanged
/// @param[in,out] occupied balls of the dynamic bodies; those of the pour are added
/// @throws FileError at the pour's place in the scene when the region is too small
std::vector<PouredBody> place_pour(const Pour& pour, const World& world, BallSet& occupied);

}  // namespace gotai::scene
