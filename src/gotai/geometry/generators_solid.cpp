#include <cmath>
#include <map>
#include <numbers>

#include "gotai/geometry/generators.h"
#include "gotai/geometry/tetrahedra.h"

namespace gotai::geometry::detail {

namespace {

/// Tetrahedra of an nx x ny x nz block of hexahedra over vertices numbered x + (nx+1) (y + (ny+1)
/// z).
/// @param periodic_z  the top layer of vertices is the bottom one again
std::vector<Tetrahedron> lattice(int nx, int ny, int nz, bool periodic_z = false) {
  const auto index = [=](int x, int y, int z) {
    if (periodic_z) z %= nz;
    return static_cast<std::uint32_t>(x + (nx + 1) * (y + (ny + 1) * z));
  };
  std::vector<Tetrahedron> tetrahedra;
  tetrahedra.reserve(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny) *
                     static_cast<std::size_t>(nz) * 6);
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x) {
        std::array<std::uint32_t, 8> corners;
        for (int c = 0; c < 8; ++c)
          corners[static_cast<std::size_t>(c)] =
              index(x + (c & 1), y + ((c >> 1) & 1), z + ((c >> 2) & 1));
        append_hexahedron(corners, tetrahedra);
      }
  return tetrahedra;
}

/// Moves a point of the square or cube [-1, 1]^n to the disc or ball of radius 1, along its ray.
template <typename Vector>
Vector to_round(const Vector& p) {
  const double norm = p.norm();
  return norm > 0.0 ? Vector(p * (p.cwiseAbs().maxCoeff() / norm)) : p;
}

}  // namespace

Mesh make_box(const Vec3& extents, int cells) {
  Mesh mesh;
  for (int z = 0; z <= cells; ++z)
    for (int y = 0; y <= cells; ++y)
      for (int x = 0; x <= cells; ++x)
        mesh.vertices.emplace_back(
            0.5 * extents.cwiseProduct(Vec3(tick(x, cells), tick(y, cells), tick(z, cells))));
  mesh.tetrahedra = lattice(cells, cells, cells);
  return mesh;
}

Mesh make_sphere(int cells) {
  Mesh mesh = make_box(Vec3::Constant(2.0), cells);
  for (Vec3& v : mesh.vertices) v = 0.5 * to_round(v);
  return mesh;
}

Mesh make_cylinder(double height, int cells) {
  // About as many layers as make the cells as high as they are wide.
  const int layers = std::max(1, static_cast<int>(std::lround(height * cells)));
  Mesh mesh;
  for (int z = 0; z <= layers; ++z)
    for (int y = 0; y <= cells; ++y)
      for (int x = 0; x <= cells; ++x) {
        const Vec2 p = 0.5 * to_round(Vec2(tick(x, cells), tick(y, cells)));
        mesh.vertices.emplace_back(p.x(), p.y(), 0.5 * height * tick(z, layers));
      }
  mesh.tetrahedra = lattice(cells, cells, layers);
  return mesh;
}

Mesh make_torus(double ratio, int cells) {
  const double ring = 0.5 / (1.0 + ratio);
  const double tube = ring * ratio;
  // Cells around the ring about as long as those around the tube (4 * cells of them).
  const int segments = 4 * std::max(cells, static_cast<int>(std::lround(cells / ratio)));
  Mesh mesh;
  for (int s = 0; s < segments; ++s) {
    const double angle = 2.0 * std::numbers::pi * s / segments;
    for (int y = 0; y <= cells; ++y)
      for (int x = 0; x <= cells; ++x) {
        const Vec2 p = tube * to_round(Vec2(tick(x, cells), tick(y, cells)));
        mesh.vertices.emplace_back((ring + p.x()) * std::cos(angle),
                                   (ring + p.x()) * std::sin(angle), p.y());
      }
  }
  mesh.tetrahedra = lattice(cells, cells, segments, true);
  return mesh;
}

Mesh make_hexapod() {
  constexpr double kRoot = 0.28;
  constexpr double kTip = 0.18;
  Mesh mesh = make_box(Vec3::Constant(2.0 * kRoot), 1);
  for (std::uint32_t axis = 0; axis < 3; ++axis)
    for (std::uint32_t side = 0; side < 2; ++side) {
      // The leg's hexahedron: bits 0 and 1 along the two other axes, bit 2 outward.
      std::array<std::uint32_t, 8> corners;
      const std::uint32_t u = axis == 0 ? 1 : 0;
      const std::uint32_t v = axis == 2 ? 1 : 2;
      for (std::uint32_t k = 0; k < 4; ++k) {
        corners[k] = (side << axis) | ((k & 1U) << u) | ((k >> 1U) << v);
        Vec3 tip = mesh.vertices[corners[k]] * (kTip / kRoot);
        tip[axis] = side == 1 ? 1.0 : -1.0;
        corners[k + 4] = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.push_back(tip);
      }
      append_hexahedron(corners, mesh.tetrahedra);
    }
  return mesh;
}

Mesh make_l() {
  constexpr std::array<std::array<int, 2>, 5> kCells = {
      {{0, 0}, {1, 0}, {2, 0}, {0, 1}, {0, 2}}};  // x, z
  Mesh mesh;
  std::map<std::array<int, 3>, std::uint32_t> known;
  for (const auto& [x, z] : kCells) {
    std::array<std::uint32_t, 8> corners;
    for (int c = 0; c < 8; ++c) {
      const std::array<int, 3> at = {x + (c & 1), (c >> 1) & 1, z + ((c >> 2) & 1)};
      const auto [entry, is_new] =
          known.try_emplace(at, static_cast<std::uint32_t>(mesh.vertices.size()));
      if (is_new) mesh.vertices.emplace_back(at[0] - 1.5, at[1] - 0.5, at[2] - 1.5);
      corners[static_cast<std::size_t>(c)] = entry->second;
    }
    append_hexahedron(corners, mesh.tetrahedra);
  }
  return mesh;
}

}  // namespace gotai::geometry::detail
