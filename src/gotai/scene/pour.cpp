#include "gotai/scene/pour.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gotai/core/random.h"

namespace gotai::scene {
namespace {

/// Consecutive rejections after which a region counts as full. Random placing alone jams at about
/// 38 % of the volume; near that more attempts gain little.
constexpr int kMostAttempts = 20'000;

/// Distance of a point from the solid of a plane or container [m]; negative inside.
double clearance_of_surroundings(const model::BodyState& bodies, model::BodyIndex i,
                                 const Vec3& center) {
  const Vec3 p = bodies.q_WB[i].conjugate() * (center - bodies.x_W[i]);
  if (bodies.geometry[i] == model::Geometry::plane) return p.z();
  const Vec3& half = bodies.half_extent[i];
  const double above_rim = p.z() - half.z();
  const double beside = std::max(std::abs(p.x()) - half.x(), std::abs(p.y()) - half.y());
  if (above_rim > 0.0) return beside > 0.0 ? above_rim : std::hypot(above_rim, beside);
  return std::min(p.z(), -beside);
}

/// Does a ball overlap a voxel sphere of a shape's pyramid? Descends from the coarsest level.
bool overlaps_voxels(const voxel::Shape& shape, int finest, const Vec3& center_M, double radius) {
  const voxel::Pyramid& pyramid = shape.pyramid;
  std::vector<std::uint32_t> voxels(pyramid.level(1).size());
  for (std::uint32_t i = 0; i < voxels.size(); ++i) voxels[i] = i;
  for (int h = 1; h <= finest && !voxels.empty(); ++h) {
    const voxel::PyramidLevel& level = pyramid.level(h);
    const double reach = radius + pyramid.grid.voxel_radius(h);
    std::vector<std::uint32_t> children;
    for (const std::uint32_t v : voxels) {
      if ((pyramid.voxel_center(h, v) - center_M).squaredNorm() >= reach * reach) continue;
      if (h == finest) return true;
      for (std::uint32_t c = level.first_child[v]; c < level.first_child[v + 1]; ++c) {
        children.push_back(c);
      }
    }
    voxels = std::move(children);
  }
  return false;
}

bool is_free(const World& world, const BallSet& occupied, const Vec3& center, double radius) {
  const model::BodyState& bodies = world.bodies();
  for (model::BodyIndex i = 0; i < bodies.size(); ++i) {
    if (bodies.geometry[i] == model::Geometry::shape) continue;
    if (clearance_of_surroundings(bodies, i, center) < radius) return false;
  }
  if (occupied.overlaps(center, radius)) return false;
  for (model::BodyIndex i = 0; i < bodies.size(); ++i) {
    if (bodies.geometry[i] != model::Geometry::shape || bodies.is_dynamic(i)) continue;
    const voxel::Shape& shape = *world.shapes()[bodies.shape[i]];
    const Vec3 center_M = bodies.mesh_pose(i).inverse() * center;
    if (overlaps_voxels(shape, world.settings().collision.level, center_M, radius)) return false;
  }
  return true;
}

}  // namespace

BallSet::BallSet(double largest_radius) : cell_edge_(2.0 * largest_radius) {}

BallSet::Cell BallSet::cell_of(const Vec3& point) const {
  Cell cell{};
  for (int k = 0; k < 3; ++k) {
    // Clamped: far-away balls share a cell instead of overflowing.
    const double index = std::clamp(std::floor(point[k] / cell_edge_), -1e15, 1e15);
    cell[static_cast<std::size_t>(k)] = static_cast<std::int64_t>(index);
  }
  return cell;
}

void BallSet::add(const Vec3& center, double radius) {
  cells_[cell_of(center)].push_back({center, radius});
}

bool BallSet::overlaps(const Vec3& center, double radius) const {
  const Cell middle = cell_of(center);
  for (std::int64_t dx = -1; dx <= 1; ++dx) {
    for (std::int64_t dy = -1; dy <= 1; ++dy) {
      for (std::int64_t dz = -1; dz <= 1; ++dz) {
        const auto cell = cells_.find({middle[0] + dx, middle[1] + dy, middle[2] + dz});
        if (cell == cells_.end()) continue;
        for (const Ball& ball : cell->second) {
          const double reach = ball.radius + radius;
          if ((ball.center - center).squaredNorm() < reach * reach) return true;
        }
      }
    }
  }
  return false;
}

double contact_radius(const voxel::Shape& shape, const model::CollisionSettings& settings) {
  const auto level = static_cast<std::size_t>(settings.level) - 1;
  return settings.model == model::CollisionModel::spheres ? shape.voxel_bounding_radius[level]
                                                          : shape.bounding_radius;
}

std::vector<PouredBody> place_pour(const Pour& pour, const World& world, BallSet& occupied) {
  Random random(pour.seed);
  std::vector<PouredBody> placed;
  placed.reserve(std::min<std::size_t>(pour.count, 1u << 20));
  while (placed.size() < pour.count) {
    const auto choice = std::min(
        static_cast<std::size_t>(random.uniform() * static_cast<double>(pour.shapes.size())),
        pour.shapes.size() - 1);
    PouredBody body{pour.shapes[choice], Vec3::Zero(), pour.rotation};
    const double radius = contact_radius(*world.shapes()[body.shape], world.settings().collision);
    int attempts = 0;
    do {
      if (++attempts > kMostAttempts) {
        fail(pour.where,
             fmt::format("the region of \"{}\" holds only {} of {} bodies without overlap (each "
                         "needs a ball of radius {:.4g} m); enlarge the region or lower the count",
                         pour.name, placed.size(), pour.count, radius));
      }
      for (int k = 0; k < 3; ++k) {
        body.com_position[k] = random.uniform(pour.region.min()[k], pour.region.max()[k]);
      }
    } while (!is_free(world, occupied, body.com_position, radius));
    if (pour.random_rotation) body.rotation = random.rotation();
    occupied.add(body.com_position, radius);
    placed.push_back(body);
  }
  return placed;
}

}  // namespace gotai::scene
