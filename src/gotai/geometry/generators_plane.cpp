#include <array>
#include <map>

#include "gotai/geometry/generators.h"

namespace gotai::geometry::detail {

namespace {

/// A quadrilateral with corners numbered bit 0 along x, bit 1 along y becomes two triangles.
void append_quadrilateral(const std::array<std::uint32_t, 4>& corners,
                          std::vector<Triangle>& triangles) {
  triangles.push_back({corners[0], corners[1], corners[3]});
  triangles.push_back({corners[0], corners[3], corners[2]});
}

}  // namespace

Mesh2 make_square(int cells) {
  Mesh2 mesh;
  for (int y = 0; y <= cells; ++y)
    for (int x = 0; x <= cells; ++x)
      mesh.vertices.emplace_back(0.5 * tick(x, cells), 0.5 * tick(y, cells));
  for (int y = 0; y < cells; ++y)
    for (int x = 0; x < cells; ++x) {
      const auto corner = static_cast<std::uint32_t>(x + (cells + 1) * y);
      const auto row = static_cast<std::uint32_t>(cells + 1);
      append_quadrilateral({corner, corner + 1, corner + row, corner + row + 1}, mesh.triangles);
    }
  return mesh;
}

Mesh2 make_circle(int cells) {
  Mesh2 mesh = make_square(cells);
  for (Vec2& v : mesh.vertices)
    if (const double norm = v.norm(); norm > 0.0) v *= v.cwiseAbs().maxCoeff() / norm;
  return mesh;
}

Mesh2 make_cross() {
  constexpr double kRoot = 0.28;
  constexpr double kTip = 0.18;
  Mesh2 mesh = make_square(1);
  for (Vec2& v : mesh.vertices) v *= 2.0 * kRoot;
  for (std::uint32_t axis = 0; axis < 2; ++axis)
    for (std::uint32_t side = 0; side < 2; ++side) {
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      std::array<std::uint32_t, 2> root;
      for (std::uint32_t k = 0; k < 2; ++k) {
        root[k] = (side << axis) | (k << (1 - axis));
        Vec2 tip = mesh.vertices[root[k]] * (kTip / kRoot);
        tip[axis] = side == 1 ? 1.0 : -1.0;
        mesh.vertices.push_back(tip);
      }
      // Counter-clockwise: the second axis is the first turned left, and so is outward at side 1.
      if ((axis == 0) == (side == 1))
        append_quadrilateral({root[0], first, root[1], first + 1}, mesh.triangles);
      else
        append_quadrilateral({first, root[0], first + 1, root[1]}, mesh.triangles);
    }
  return mesh;
}

Mesh2 make_plane_l() {
  constexpr std::array<std::array<int, 2>, 5> kCells = {{{0, 0}, {1, 0}, {2, 0}, {0, 1}, {0, 2}}};
  Mesh2 mesh;
  std::map<std::array<int, 2>, std::uint32_t> known;
  for (const auto& [x, y] : kCells) {
    std::array<std::uint32_t, 4> corners;
    for (int c = 0; c < 4; ++c) {
      const std::array<int, 2> at = {x + (c & 1), y + (c >> 1)};
      const auto [entry, is_new] =
          known.try_emplace(at, static_cast<std::uint32_t>(mesh.vertices.size()));
      if (is_new) mesh.vertices.emplace_back(at[0] - 1.5, at[1] - 1.5);
      corners[static_cast<std::size_t>(c)] = entry->second;
    }
    append_quadrilateral(corners, mesh.triangles);
  }
  return mesh;
}

}  // namespace gotai::geometry::detail
