#include "gotai/voxel/surface_model.h"

#include <cmath>
#include <string>

#include "gotai/core/error.h"

namespace gotai::voxel {

SurfaceModel make_surface_model(const geometry::Mesh& mesh, int level, const WindingTree* inside) {
  if (level < kMinSurfaceLevel || level > kMaxSurfaceLevel) {
    throw InvalidArgument(
        "shape.surface_level", std::to_string(level),
        "must be " + std::to_string(kMinSurfaceLevel) + ".." + std::to_string(kMaxSurfaceLevel));
  }
  const SignedDistance surface(mesh, inside);
  Box3 box;
  for (std::uint32_t v = 0; v < surface.vertex_count(); ++v) box.extend(surface.vertex(v));
  SurfaceModel model;
  model.level = level;
  model.center = box.center();
  model.edge = box.sizes().maxCoeff();
  model.spacing = std::ldexp(model.edge, 1 - level);
  const std::vector<SurfaceSample> samples = sample_surface(surface, model.spacing);
  for (const SurfaceSample& s : samples) model.area += s.area;
  model.tree = make_surface_tree(samples, model.center);
  model.field = make_distance_field(surface, model.center, model.edge, level + 1);
  return model;
}

}  // namespace gotai::voxel
