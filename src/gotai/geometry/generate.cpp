#include "gotai/geometry/generate.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "gotai/core/error.h"
#include "gotai/geometry/generators.h"
#include "gotai/geometry/tetrahedra.h"

namespace gotai::geometry {

namespace {

void require(bool condition, std::string_view name, const std::string& value,
             std::string_view reason) {
  if (!condition) throw InvalidArgument(name, value, reason);
}

void validate(const GeneratorOptions& options, const std::vector<std::string>& names) {
  require(std::ranges::find(names, options.shape) != names.end(), "generate", options.shape,
          fmt::format("must be one of {}", fmt::join(names, ", ")));
  require(std::isfinite(options.size) && options.size >= 0.0, "size",
          fmt::format("{}", options.size), "must be a positive length, or 0 for the natural size");
  require(
      options.extents.allFinite() && options.extents.minCoeff() > 0.0, "extents",
      fmt::format("[{}, {}, {}]", options.extents.x(), options.extents.y(), options.extents.z()),
      "must be three positive lengths");
  require(std::isfinite(options.thickness) && options.thickness >= 0.0, "thickness",
          fmt::format("{}", options.thickness), "must be > 0, or 0 for the shape's own");
  require(options.shape != "torus" || options.thickness < 1.0, "thickness",
          fmt::format("{}", options.thickness), "must be < 1 for a torus");
  require(options.roughness >= 0.0 && options.roughness < 0.9, "roughness",
          fmt::format("{}", options.roughness), "must be in [0, 0.9)");
  const int finest = options.shape == "rock" ? 8 : 64;
  require(options.subdivisions >= 0 && options.subdivisions <= finest, "subdivisions",
          fmt::format("{}", options.subdivisions),
          fmt::format("must be in 1..{}, or 0 for the shape's own", finest));
}

template <typename Vertex>
void scale_to(std::vector<Vertex>& vertices, double size) {
  if (size == 0.0) return;
  Vertex low = vertices.front();
  Vertex high = vertices.front();
  for (const Vertex& v : vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  const double factor = size / (high - low).maxCoeff();
  for (Vertex& v : vertices) v *= factor;
}

Mesh make(const GeneratorOptions& o) {
  const auto fineness = [&o](int own) { return o.subdivisions > 0 ? o.subdivisions : own; };
  const auto thickness = [&o](double own) { return o.thickness > 0.0 ? o.thickness : own; };
  if (o.shape == "box") return detail::make_box(o.extents, fineness(1));
  if (o.shape == "cylinder") return detail::make_cylinder(thickness(1.0), fineness(6));
  if (o.shape == "disc") return detail::make_cylinder(thickness(0.1), fineness(6));
  if (o.shape == "hexapod") return detail::make_hexapod();
  if (o.shape == "l") return detail::make_l();
  if (o.shape == "rock") return detail::make_rock(fineness(3), o.seed, o.roughness);
  if (o.shape == "sphere") return detail::make_sphere(fineness(6));
  if (o.shape == "torus") return detail::make_torus(thickness(0.3), fineness(4));
  return detail::make_box(Vec3::Ones(), fineness(1));
}

Mesh2 make_plane(const GeneratorOptions& o) {
  if (o.shape == "circle") return detail::make_circle(o.subdivisions > 0 ? o.subdivisions : 8);
  if (o.shape == "cross") return detail::make_cross();
  if (o.shape == "l") return detail::make_plane_l();
  return detail::make_square(o.subdivisions > 0 ? o.subdivisions : 1);
}

}  // namespace

const std::vector<std::string>& generator_names() {
  static const std::vector<std::string> names = {"box", "cube", "cylinder", "disc", "hexapod",
                                                 "l",   "rock", "sphere",   "torus"};
  return names;
}

const std::vector<std::string>& plane_generator_names() {
  static const std::vector<std::string> names = {"circle", "cross", "l", "square"};
  return names;
}

Mesh generate(const GeneratorOptions& options) {
  validate(options, generator_names());
  Mesh mesh = make(options);
  scale_to(mesh.vertices, options.size);
  orient_tetrahedra(mesh);
  mesh.triangles = boundary_triangles(mesh.tetrahedra);
  return mesh;
}

Mesh2 generate_plane(const GeneratorOptions& options) {
  validate(options, plane_generator_names());
  Mesh2 mesh = make_plane(options);
  scale_to(mesh.vertices, options.size);
  return mesh;
}

}  // namespace gotai::geometry
