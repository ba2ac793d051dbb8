#include "gotai/collision/sample_candidates.h"

#include <algorithm>
#include <bit>

namespace gotai::collision {
namespace {

using Lanes = HitLanes::Lanes;

void put(const std::array<float, 3>& v, std::array<Lanes, 3>& to, std::size_t lane) {
  for (std::size_t k = 0; k < 3; ++k) to[k][lane] = v[k];
}

void put(const Vec3& v, std::array<Lanes, 3>& to, std::size_t lane) {
  for (int k = 0; k < 3; ++k) to[static_cast<std::size_t>(k)][lane] = static_cast<float>(v[k]);
}

void put_bulge(const CurvedSample& bulge, HitLanes& to, std::size_t lane) {
  to.bulge[lane] = 1.0F;
  put(bulge.point, to.bulge_point, lane);
  put(bulge.normal, to.bulge_normal, lane);
  for (std::size_t k = 0; k < 2; ++k) {
    put(bulge.direction[k], to.bulge_direction[k], lane);
    to.bulge_curvature[k][lane] = static_cast<float>(bulge.curvature[static_cast<int>(k)]);
  }
}

// Where the surface is not curved: nothing slides.
void put_no_bulge(HitLanes& to, std::size_t lane) {
  to.bulge[lane] = 0.0F;
  constexpr std::array<float, 3> kNone{};
  put(kNone, to.bulge_point, lane);
  put(kNone, to.bulge_normal, lane);
  for (std::size_t k = 0; k < 2; ++k) {
    put(kNone, to.bulge_direction[k], lane);
    to.bulge_curvature[k][lane] = 0.0F;
  }
}

// Brings together what is known of up to eight hits. Other lanes keep what they have: nobody looks
// at what becomes of them.
void collect(const NearSurface& near, std::span<const SurfaceHit> hits, HitLanes& to) {
  const voxel::SurfaceTree& tree = near.samples.tree;
  to.any_edge = false;
  to.any_bulge = false;
  std::array<const CurvedSample*, voxel::kLanes> bulges{};
  for (std::size_t lane = 0; lane < hits.size(); ++lane) {
    const SurfaceHit& hit = hits[lane];
    const std::uint32_t s = hit.sample;
    const voxel::PointPacket& packet = tree.points[s / voxel::kLanes];
    to.point[0][lane] = packet.x[s % voxel::kLanes];
    to.point[1][lane] = packet.y[s % voxel::kLanes];
    to.point[2][lane] = packet.z[s % voxel::kLanes];
    to.distance[lane] = hit.distance;
    put(hit.gradient, to.gradient, lane);
    const voxel::SurfaceElement& element = tree.elements[s];
    put(unit_normal(element), to.axis, lane);
    to.cosine[lane] = element.cone_cosine;
    put(tree.vector_area(s), to.area, lane);
    const voxel::SampleEdge* edge = tree.edge_of(s);
    to.any_edge |= edge != nullptr;
    put(edge == nullptr ? std::array<float, 3>{} : edge->direction, to.along, lane);
    to.reach_back[lane] = edge == nullptr ? 0.0F : edge->back;
    to.reach_forward[lane] = edge == nullptr ? 0.0F : edge->forward;
    if (near.curved != nullptr) bulges[lane] = near.curved->find(s);
    to.any_bulge |= bulges[lane] != nullptr;
  }
  if (!to.any_bulge) return;
  for (std::size_t lane = 0; lane < hits.size(); ++lane) {
    if (bulges[lane] != nullptr) {
      put_bulge(*bulges[lane], to, lane);
    } else {
      put_no_bulge(to, lane);
    }
  }
}

Vec3 lane_of(const std::array<CandidateLanes::Wide, 3>& v, std::size_t lane) {
  return {v[0][lane], v[1][lane], v[2][lane]};
}

void append_lanes(const NearSurface& near, std::span<const SurfaceHit> hits,
                  const CandidateLanes& from, std::vector<ContactCandidate>& out) {
  const voxel::SurfaceTree& tree = near.samples.tree;
  std::uint32_t mask = from.counts;
  if (hits.size() < voxel::kLanes) mask &= (1U << hits.size()) - 1U;
  for (; mask != 0U; mask &= mask - 1U) {
    const auto lane = static_cast<std::size_t>(std::countr_zero(mask));
    const std::uint32_t s = hits[lane].sample;
    out.push_back({.point_A = lane_of(from.point, lane),
                   .normal_A = lane_of(from.normal, lane),
                   .gap = static_cast<double>(from.gap[lane]),
                   .area = static_cast<double>(from.area[lane]),
                   .share_A = lane_of(from.point, lane),
                   .feature = surface_feature(near.samples_of_b ? 1 : 0, s),
                   .crosses = (from.crosses >> lane & 1U) != 0U,
                   .near_edge = (from.rough >> lane & 1U) != 0U || tree.edge_of(s) != nullptr ||
                                tree.has_vertices(s)});
  }
}

}  // namespace

void append_candidates(const NearSurface& near, std::span<const SurfaceHit> hits, float margin,
                       const Closing& closing, CandidateScratch& scratch,
                       std::vector<ContactCandidate>& out, Kernel kernel) {
  const std::size_t packets = (hits.size() + voxel::kLanes - 1) / voxel::kLanes;
  if (scratch.hits.size() < packets) {
    scratch.hits.resize(packets);
    scratch.candidates.resize(packets);
  }
  const auto part = [&](std::size_t i) {
    const std::size_t first = i * voxel::kLanes;
    return hits.subspan(first, std::min<std::size_t>(voxel::kLanes, hits.size() - first));
  };
  for (std::size_t i = 0; i < packets; ++i) collect(near, part(i), scratch.hits[i]);
  make_candidates(near, margin, closing, scratch.hits.data(), packets, scratch.candidates.data(),
                  kernel);
  for (std::size_t i = 0; i < packets; ++i) {
    append_lanes(near, part(i), scratch.candidates[i], out);
  }
}

}  // namespace gotai::collision
