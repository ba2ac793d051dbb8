/// @file
/// Shapes made straight from a predicate, so that collision is tested without meshes.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "gotai/model/body_state.h"
#include "gotai/voxel/shape.h"

namespace gotai::test {

/// Bits of (x, y, z) interleaved, x lowest.
inline std::uint32_t morton(const std::array<std::uint16_t, 3>& index) {
  std::uint32_t code = 0;
  for (std::uint32_t bit = 0; bit < 9; ++bit) {
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      code |= ((index[axis] >> bit) & 1U) << (3 * bit + axis);
    }
  }
  return code;
}

/// Pyramid of the surface voxels of the set inside(x_M), by the thesis's rules: the finest level is
/// tested at the voxels' centres and reduced to voxels with an empty 6-neighbour, then merged.
template <typename Inside>
voxel::Pyramid make_test_pyramid(const voxel::VoxelGrid& grid, int max_level,
                                 const Inside& inside) {
  voxel::Pyramid pyramid;
  pyramid.grid = grid;
  pyramid.levels.resize(static_cast<std::size_t>(max_level));
  const int n = 1 << (max_level - 1);
  std::vector<bool> filled(static_cast<std::size_t>(n) * static_cast<std::size_t>(n) *
                           static_cast<std::size_t>(n));
  const auto at = [n](int x, int y, int z) {
    return static_cast<std::size_t>(x) +
           static_cast<std::size_t>(n) *
               (static_cast<std::size_t>(y) +
                static_cast<std::size_t>(n) * static_cast<std::size_t>(z));
  };
  const auto index_of = [](int x, int y, int z) {
    return std::array<std::uint16_t, 3>{static_cast<std::uint16_t>(x),
                                        static_cast<std::uint16_t>(y),
                                        static_cast<std::uint16_t>(z)};
  };
  for (int z = 0; z < n; ++z)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x)
        filled[at(x, y, z)] = inside(grid.voxel_center(max_level, index_of(x, y, z)));
  const auto empty = [&](int x, int y, int z) {
    return x < 0 || y < 0 || z < 0 || x >= n || y >= n || z >= n || !filled[at(x, y, z)];
  };
  auto& finest = pyramid.levels.back().index;
  for (int z = 0; z < n; ++z)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x)
        if (filled[at(x, y, z)] &&
            (empty(x - 1, y, z) || empty(x + 1, y, z) || empty(x, y - 1, z) || empty(x, y + 1, z) ||
             empty(x, y, z - 1) || empty(x, y, z + 1)))
          finest.push_back(index_of(x, y, z));
  std::sort(finest.begin(), finest.end(),
            [](const auto& a, const auto& b) { return morton(a) < morton(b); });
  for (int h = max_level - 1; h >= 1; --h) {
    voxel::PyramidLevel& parents = pyramid.levels[static_cast<std::size_t>(h) - 1];
    const voxel::PyramidLevel& children = pyramid.level(h + 1);
    for (std::size_t c = 0; c < children.size(); ++c) {
      const auto& i = children.index[c];
      const auto parent = index_of(i[0] / 2, i[1] / 2, i[2] / 2);
      if (parents.index.empty() || parents.index.back() != parent) {
        parents.index.push_back(parent);
        parents.first_child.push_back(static_cast<std::uint32_t>(c));
      }
    }
    parents.first_child.push_back(static_cast<std::uint32_t>(children.size()));
  }
  return pyramid;
}

/// A shape of unit density-less mass data: only what collision reads. Centre of mass at com_M.
template <typename Inside>
std::shared_ptr<const voxel::Shape> make_test_shape(std::string name, const voxel::VoxelGrid& grid,
                                                    int max_level, const Vec3& com_M,
                                                    const Inside& inside) {
  auto shape = std::make_shared<voxel::Shape>();
  shape->name = std::move(name);
  shape->pyramid = make_test_pyramid(grid, max_level, inside);
  for (int h = 1; h <= max_level; ++h) {
    double rho = 0.0;
    for (const Vec3& c : shape->pyramid.voxel_centers(h)) rho = std::max(rho, (c - com_M).norm());
    shape->voxel_bounding_radius.push_back(rho + grid.voxel_radius(h));
  }
  shape->bounding_radius = shape->voxel_bounding_radius.back();
  return shape;
}

/// Unit cube centred on the mesh frame's origin.
inline std::shared_ptr<const voxel::Shape> unit_cube(int max_level) {
  return make_test_shape("cube", {Vec3(-0.5, -0.5, -0.5), 1.0}, max_level, Vec3::Zero(),
                         [](const Vec3&) { return true; });
}

/// Six tapered legs: non-convex. Extent 2, centred on the origin.
inline std::shared_ptr<const voxel::Shape> six_legs(int max_level) {
  return make_test_shape(
      "six legs", {Vec3(-1, -1, -1), 2.0}, max_level, Vec3::Zero(), [](const Vec3& x) {
        std::array<double, 3> a{std::abs(x.x()), std::abs(x.y()), std::abs(x.z())};
        std::sort(a.begin(), a.end());
        const double width = 0.28 - 0.1 * std::max(0.0, a[2] - 0.28) / 0.72;
        return a[1] <= width;
      });
}

/// Torus of extent 1 in the x-y plane, centred on the origin.
inline std::shared_ptr<const voxel::Shape> ring(int max_level) {
  return make_test_shape("ring", {Vec3(-0.5, -0.5, -0.5), 1.0}, max_level, Vec3::Zero(),
                         [](const Vec3& x) {
                           const double d = std::hypot(x.x(), x.y()) - 0.35;
                           return d * d + x.z() * x.z() <= 0.15 * 0.15;
                         });
}

/// Bumpy ball of extent about 1, centred on the origin.
inline std::shared_ptr<const voxel::Shape> bumpy_ball(int max_level) {
  return make_test_shape(
      "bumpy ball", {Vec3(-0.5, -0.5, -0.5), 1.0}, max_level, Vec3::Zero(), [](const Vec3& x) {
        const double r = x.norm();
        if (r < 1e-9) return true;
        const Vec3 u = x / r;
        return r <= 0.42 * (1.0 + 0.1 * std::sin(5 * u.x()) * std::cos(4 * u.y() + u.z()));
      });
}

/// Appends a body of a shape (index into the list of shapes), dynamic with mass 1 or fixed.
inline model::BodyIndex add_test_body(model::BodyState& bodies, const voxel::Shape& shape,
                                      std::uint32_t shape_index, const Pose& pose, int level,
                                      bool dynamic = true) {
  const model::BodyIndex i = model::append_body(bodies);
  bodies.geometry[i] = model::Geometry::shape;
  bodies.kind[i] = dynamic ? model::BodyKind::dynamic : model::BodyKind::fixed;
  bodies.inverse_mass[i] = dynamic ? 1.0 : 0.0;
  bodies.x_W[i] = pose.p;
  bodies.q_WB[i] = pose.q;
  bodies.shape[i] = shape_index;
  bodies.bounding_radius[i] = shape.voxel_bounding_radius[static_cast<std::size_t>(level) - 1];
  bodies.voxel_radius[i] = shape.pyramid.grid.voxel_radius(level);
  return i;
}

/// Appends a plane or a container.
inline model::BodyIndex add_test_boundary(model::BodyState& bodies, model::Geometry geometry,
                                          const Pose& pose = {},
                                          const Vec3& half_extent = Vec3::Zero()) {
  const model::BodyIndex i = model::append_body(bodies);
  bodies.geometry[i] = geometry;
  bodies.kind[i] = model::BodyKind::fixed;
  bodies.inverse_mass[i] = 0.0;
  bodies.x_W[i] = pose.p;
  bodies.q_WB[i] = pose.q;
  bodies.half_extent[i] = half_extent;
  return i;
}

}  // namespace gotai::test
