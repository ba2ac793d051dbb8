#include "gotai/voxel/surface_model.h"

#include <cmath>
#include <string>

#include "gotai/core/error.h"
#include "gotai/voxel/surface_accuracy.h"

namespace gotai::voxel {
namespace {

// Samples and field of one level.
void build_level(const SignedDistance& surface, int level, SurfaceModel& model,
                 std::vector<SurfaceSample>& samples) {
  model.level = level;
  model.spacing = std::ldexp(model.edge, 1 - level);
  samples = sample_surface(surface, model.spacing);
  model.field = make_distance_field(surface, model.center, model.edge, level + 1);
}

// The coarsest level at which walls are a voxel thick.
int level_for_walls(const SignedDistance& surface, const SurfaceModel& model,
                    const std::vector<SurfaceSample>& samples) {
  const double thickness = wall_thickness(surface, samples, model.spacing);
  int level = model.level;
  while (level < kMaxSurfaceLevel && std::ldexp(model.edge, 1 - level) > thickness) ++level;
  return level;
}

}  // namespace

SurfaceModel make_surface_model(const geometry::Mesh& mesh, int level, double accuracy,
                                const WindingTree* inside) {
  if (level < kMinSurfaceLevel || level > kMaxSurfaceLevel) {
    throw InvalidArgument(
        "shape.surface_level", std::to_string(level),
        "must be " + std::to_string(kMinSurfaceLevel) + ".." + std::to_string(kMaxSurfaceLevel));
  }
  if (!(accuracy >= 0.0))
    throw InvalidArgument("shape.accuracy", std::to_string(accuracy),
                          "must be 0 (none) or positive, a fraction of the largest extent");
  const SignedDistance surface(mesh, inside);
  Box3 box;
  for (std::uint32_t v = 0; v < surface.vertex_count(); ++v) box.extend(surface.vertex(v));
  SurfaceModel model;
  model.center = box.center();
  model.edge = box.sizes().maxCoeff();
  std::vector<SurfaceSample> samples;
  build_level(surface, level, model, samples);
  if (accuracy > 0.0) {
    const int for_walls = level_for_walls(surface, model, samples);
    if (for_walls > level) build_level(surface, for_walls, model, samples);
    while (model.level < kMaxSurfaceLevel &&
           field_error(surface, samples, model.field, model.center, model.spacing) >
               accuracy * model.edge)
      build_level(surface, model.level + 1, model, samples);
  }
  for (const SurfaceSample& s : samples) model.area += s.area;
  model.tree = make_surface_tree(samples, model.center);
  return model;
}

}  // namespace gotai::voxel
