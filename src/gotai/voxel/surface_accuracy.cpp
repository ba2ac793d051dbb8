#include "gotai/voxel/surface_accuracy.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "gotai/core/random.h"

namespace gotai::voxel {
namespace {

constexpr std::size_t kMostSamples = 2000;
constexpr double kIgnoredArea = 0.01;  // of the surface
constexpr double kOtherSide = -0.5;    // cosine: normals of the two sides of a wall

std::size_t stride_of(const std::vector<SurfaceSample>& samples) {
  return std::max<std::size_t>(1, samples.size() / kMostSamples);
}

// From a point of the surface straight into the body to where it ends, by steps that the distance
// allows; infinite when that is farther than the limit or not another side of the wall.
double thickness_at(const SignedDistance& surface, const SurfaceSample& sample, double limit) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const double least = 1e-4 * limit;
  double depth = least;
  while (depth < limit) {
    const ClosestPoint nearest = surface.query(sample.position - depth * sample.normal);
    if (nearest.distance > -least && depth > least) {
      const bool other_side = surface.face_normal(nearest.triangle).dot(sample.normal) < kOtherSide;
      return other_side ? depth : kNone;
    }
    depth += std::max(least, -nearest.distance);
  }
  return kNone;
}

}  // namespace

double wall_thickness(const SignedDistance& surface, const std::vector<SurfaceSample>& samples,
                      double limit) {
  std::vector<std::pair<double, double>> walls;  // thickness and area
  double area = 0.0;
  for (std::size_t i = 0; i < samples.size(); i += stride_of(samples)) {
    if (samples[i].kind != SampleKind::face) continue;
    walls.emplace_back(thickness_at(surface, samples[i], limit), samples[i].area);
    area += samples[i].area;
  }
  std::sort(walls.begin(), walls.end());
  double thinner = 0.0;
  for (const auto& [thickness, share] : walls) {
    thinner += share;
    if (thinner > kIgnoredArea * area) return thickness;
  }
  return std::numeric_limits<double>::infinity();
}

double field_error(const SignedDistance& surface, const std::vector<SurfaceSample>& samples,
                   const DistanceField& field, const Vec3& center, double reach) {
  Random random(1);
  double squares = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < samples.size(); i += stride_of(samples)) {
    const Vec3 x = samples[i].position + reach * random.uniform(0.0, 1.0) * random.unit_vector();
    const double error = evaluate(field, x - center).distance - surface.query(x).distance;
    squares += error * error;
    count += 1.0;
  }
  return std::sqrt(squares / std::max(1.0, count));
}

}  // namespace gotai::voxel
