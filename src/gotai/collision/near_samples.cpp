#include "gotai/collision/near_samples.h"

#include <cmath>

// Why the packets suffice. Let f be the value that a sample gets (surface_search.cpp), y where the
// sample was and x where it is, |x - y| <= d, c the cell. Suppose f(y) > M >= 0 (its packet was not
// noted) and f(x) <= margin.
// If the segment from x to y stays where bricks are trusted, f is continuous on it and steeper
// nowhere than `slope`: f(y) <= margin + slope d.
// Otherwise some point z of it is at least n = `nearest_coarse` (2.4 c) from the surface. Let d <=
// c/2. If z is outside, phi(x) >= n - d >= 1.9 c; where x has a trusted value, f(x) >= phi(x) -
// sqrt(3)/2 c > c, and elsewhere f(x) >= n: so not f(x) <= margin <= c. If z is inside, phi(y) <=
// -n + d <= -1.9 c, hence f(y) < 0 <= M. Beyond the lattice's cube, which is four cells from the
// shape, f > c. So M >= margin + slope d, d <= c/2 and margin <= c are enough.

namespace gotai::collision {
namespace {

constexpr float kAllowance = 0.35F;      // motion that a list is made for [cells]
constexpr float kShortestLife = 3.0F;    // searches that a list must serve to be worth making
constexpr float kFloatRounding = 2e-3F;  // of single-precision positions and values [cells]

// No point nearer to the samples' origin than `radius` has moved farther between two poses.
float farthest_sample(const SamplePose& from, const SamplePose& to, float radius) {
  float turned = 0.0F;
  for (std::size_t i = 0; i < 9; ++i) {
    const float difference = to.rotation[i] - from.rotation[i];
    turned += difference * difference;
  }
  float moved = 0.0F;
  for (std::size_t i = 0; i < 3; ++i) {
    const float difference = to.translation[i] - from.translation[i];
    moved += difference * difference;
  }
  return std::sqrt(moved) + std::sqrt(turned) * radius;  // Frobenius norm >= spectral norm
}

bool suffices(const NearSamples& near, float moved, float margin,
              const voxel::DistanceField& field) {
  return near.margin >= 0.0F && moved <= 0.5F * field.cell && margin <= field.cell &&
         near.margin >= margin + field.slope * moved + kFloatRounding * field.cell;
}

}  // namespace

bool is_still_empty(const NearSamples& near, float moved, float margin,
                    const voxel::DistanceField& field) {
  return near.packets.empty() && suffices(near, near.moved + moved, margin, field);
}

void search_field(const voxel::SurfaceModel& samples, const voxel::DistanceField& field,
                  const SamplePose& pose, SearchReach reach, double motion, NearSamples& near,
                  SurfaceSearch& search) {
  // Samples lie in the shape's cube.
  const float radius = static_cast<float>(0.8661 * samples.edge);
  if (near.margin >= 0.0F) near.moved = farthest_sample(near.pose, pose, radius);
  if (suffices(near, near.moved, reach.margin, field)) {
    search_packets(samples.tree, field, pose, reach, near.packets, search);
    return;
  }
  near.forget();
  const float allowance = kAllowance * field.cell;
  if (reach.margin > field.cell || static_cast<float>(motion) * kShortestLife > allowance) {
    search_field(samples.tree, field, pose, reach, search);
    return;
  }
  near.margin = reach.margin + field.slope * allowance + kFloatRounding * field.cell;
  near.pose = pose;
  near.moved = 0.0F;
  search_and_list(samples.tree, field, pose, reach, near.margin, search, near.packets);
}

}  // namespace gotai::collision
