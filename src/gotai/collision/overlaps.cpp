#include "gotai/collision/overlaps.h"

#include <algorithm>
#include <utility>

#include "gotai/collision/find_contacts.h"
#include "gotai/collision/relative_pose.h"
#include "gotai/collision/surface_search.h"

namespace gotai::collision {
namespace {

using Shapes = std::span<const std::shared_ptr<const voxel::Shape>>;

// How deep the deepest sample of one surface is inside the other body [m]; 0: none is.
double deepest_sample(const voxel::SurfaceModel& samples, const voxel::SurfaceModel& body,
                      const Pose& X_BS, SurfaceSearch& search) {
  const SamplePose pose =
      make_sample_pose(X_BS.q.toRotationMatrix(), X_BS * samples.center - body.center);
  search_field(samples.tree, body.field, pose, {0.0F, 0.0F}, search);
  float least = 0.0F;
  for (const SurfaceHit& hit : search.hits) least = std::min(least, hit.distance);
  return -static_cast<double>(least);
}

void add_deepest_samples(const model::BodyState& bodies, Shapes shapes,
                         std::vector<PairOverlap>& overlaps) {
  BroadPhase broad_phase;
  std::vector<BodyPair> pairs;
  broad_phase.find_pairs(bodies, bodies.bounding_radius, 0.0, pairs);
  SurfaceSearch search;
  for (const BodyPair& pair : pairs) {
    if (bodies.geometry[pair.body_b] != model::Geometry::shape) continue;
    const voxel::SurfaceModel& a = shapes[bodies.shape[pair.body_a]]->surface;
    const voxel::SurfaceModel& b = shapes[bodies.shape[pair.body_b]]->surface;
    const Pose X_WA = bodies.mesh_pose(pair.body_a);
    const Pose X_WB = bodies.mesh_pose(pair.body_b);
    const double depth = std::max(deepest_sample(a, b, relative_pose(X_WB, X_WA), search),
                                  deepest_sample(b, a, relative_pose(X_WA, X_WB), search));
    if (depth > 0.0) overlaps.push_back({pair, depth});
  }
}

// The deepest of each pair, ascending.
void keep_deepest(std::vector<PairOverlap>& overlaps) {
  const auto key = [](const PairOverlap& o) { return std::pair(o.pair.body_a, o.pair.body_b); };
  std::ranges::sort(overlaps, [&](const PairOverlap& a, const PairOverlap& b) {
    return key(a) != key(b) ? key(a) < key(b) : a.depth > b.depth;
  });
  const auto is_same = [](const PairOverlap& a, const PairOverlap& b) { return a.pair == b.pair; };
  overlaps.erase(std::unique(overlaps.begin(), overlaps.end(), is_same), overlaps.end());
}

}  // namespace

std::vector<PairOverlap> find_overlaps(const model::BodyState& bodies, Shapes shapes,
                                       const model::CollisionSettings& settings) {
  model::ContactSet contacts;
  CollisionCache cache;
  find_contacts(bodies, shapes, settings, 0.0, cache, contacts);
  std::vector<PairOverlap> overlaps;
  for (const model::ContactPair& pair : contacts.pairs) {
    double depth = 0.0;
    for (std::uint32_t c = pair.begin; c < pair.end; ++c) depth = std::max(depth, -contacts.gap[c]);
    if (depth > 0.0) overlaps.push_back({{pair.body_a, pair.body_b}, depth});
  }
  if (settings.model == model::CollisionModel::surface)
    add_deepest_samples(bodies, shapes, overlaps);
  keep_deepest(overlaps);
  return overlaps;
}

}  // namespace gotai::collision
