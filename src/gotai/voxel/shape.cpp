#include "gotai/voxel/shape.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "gotai/core/error.h"
#include "gotai/voxel/inside.h"

namespace gotai::voxel {
namespace {

/// Raise it whenever the same mesh and options lead to another shape.
constexpr std::uint32_t kRecipe = 2;

template <typename Simplex>
void check_indices(const std::vector<Simplex>& simplices, std::size_t vertices, const char* kind) {
  for (std::size_t i = 0; i < simplices.size(); ++i)
    for (const std::uint32_t v : simplices[i])
      if (v >= vertices)
        throw InvalidArgument("mesh", fmt::format("vertex {} in {} {}", v, kind, i),
                              fmt::format("there are {} vertices, counted from 0", vertices));
}

void check_input(const geometry::Mesh& mesh, const ShapeOptions& options) {
  if (options.prepared_level < 1 || options.prepared_level > kMaxLevel)
    throw InvalidArgument("level", fmt::format("{}", options.prepared_level),
                          fmt::format("must be 1..{}", kMaxLevel));
  check_indices(mesh.triangles, mesh.vertices.size(), "triangle");
  check_indices(mesh.tetrahedra, mesh.vertices.size(), "tetrahedron");
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    if (!mesh.vertices[i].allFinite())
      throw InvalidArgument("mesh", fmt::format("vertex {}", i), "is not finite");
  if (!mesh.has_tetrahedra() && !has_closed_surface(mesh))
    throw InvalidArgument("mesh", fmt::format("{} triangles", mesh.triangles.size()),
                          "the surface is not closed");
}

VoxelSet voxels_inside(const geometry::Mesh& mesh, const VoxelGrid& grid, int level) {
  return mesh.has_tetrahedra() ? voxels_in_tetrahedra(mesh, grid, level)
                               : voxels_in_closed_surface(mesh, grid, level);
}

/// The message of a body that falls between the voxels' centres.
[[noreturn]] void throw_too_thin(const geometry::Mesh& mesh, const VoxelGrid& grid, int level) {
  std::string advice = fmt::format("not even level {} has one; make the body thicker", kMaxLevel);
  for (int finer = level + 1; finer <= kMaxLevel; ++finer)
    if (!voxels_inside(mesh, grid, finer).empty()) {
      advice = fmt::format("use level {}", finer);
      break;
    }
  throw InvalidArgument("level", fmt::format("{}", level),
                        "the body is too thin: no voxel's centre is inside; " + advice);
}

double bounding_radius(const geometry::Mesh& mesh, const Vec3& center) {
  double squared = 0.0;
  const auto reach = [&](std::uint32_t v) {
    squared = std::max(squared, (mesh.vertices[v] - center).squaredNorm());
  };
  for (const geometry::Triangle& t : mesh.triangles) std::for_each(t.begin(), t.end(), reach);
  for (const geometry::Tetrahedron& t : mesh.tetrahedra) std::for_each(t.begin(), t.end(), reach);
  return std::sqrt(squared);
}

double voxel_bounding_radius(const PyramidLevel& level, double voxel_radius, const Vec3& center) {
  double squared = 0.0;
  for (const Vec3& c : level.center) squared = std::max(squared, (c - center).squaredNorm());
  return std::sqrt(squared) + voxel_radius;
}

}  // namespace

Hash128 content_hash(const geometry::Mesh& mesh, const ShapeOptions& options) {
  Hasher hasher;
  hasher.value(kRecipe).value(static_cast<std::int32_t>(options.prepared_level));
  hasher.value(static_cast<std::int32_t>(options.surface_level));
  // Vectors and index arrays are plain coordinates without padding.
  hasher.array(std::span<const Vec3>(mesh.vertices));
  hasher.array(std::span<const geometry::Triangle>(mesh.triangles));
  hasher.array(std::span<const geometry::Tetrahedron>(mesh.tetrahedra));
  return hasher.digest();
}

Shape make_shape(std::string name, geometry::Mesh mesh, const ShapeOptions& options) {
  check_input(mesh, options);
  const VoxelGrid grid = grid_around(geometry::bounding_box(mesh));
  Shape shape;
  shape.content = content_hash(mesh, options);
  shape.mass = geometry::mass_properties(mesh);
  const VoxelSet inside = voxels_inside(mesh, grid, options.prepared_level);
  if (inside.empty()) throw_too_thin(mesh, grid, options.prepared_level);
  shape.pyramid = build_pyramid(grid, inside);
  if (options.surface_level != 0) {
    shape.surface = make_surface_model(mesh, options.surface_level);
  }
  shape.name = std::move(name);
  shape.mesh = std::move(mesh);
  derive_radii(shape);
  return shape;
}

void derive_radii(Shape& shape) {
  const Pyramid& pyramid = shape.pyramid;
  const Vec3& center = shape.mass.center_of_mass;
  shape.bounding_radius = bounding_radius(shape.mesh, center);
  shape.voxel_bounding_radius.clear();
  for (int h = 1; h <= pyramid.max_level(); ++h)
    shape.voxel_bounding_radius.push_back(
        voxel_bounding_radius(pyramid.level(h), pyramid.grid.voxel_radius(h), center));
}

}  // namespace gotai::voxel
