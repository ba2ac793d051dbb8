#include "gotai/collision/sphere_descent.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>

namespace gotai::collision {

namespace {

using Group = DescentScratch::Group;
using Frontier = DescentScratch::Frontier;
using Float4 = DescentScratch::Float4;
using Int4 = std::int32_t __attribute__((vector_size(16)));
using Long2 = std::int64_t __attribute__((vector_size(16)));

// Bound on the rounding of the single-precision differences over all levels, as a fraction of the
// largest lengths involved (each level rounds 3 components twice; 9 levels stay below 40 ulp).
constexpr double kRounding = 40.0 * 0x1p-24;

constexpr std::array<std::uint8_t, 256> kBitCount = [] {
  std::array<std::uint8_t, 256> count{};
  for (std::size_t i = 1; i < count.size(); ++i) {
    count[i] = static_cast<std::uint8_t>(count[i / 2] + i % 2);
  }
  return count;
}();

/// Position of a child relative to its parent's centre, in half edges of the child.
Vec3 octant_sign(std::uint32_t octant) {
  return {(octant & 1U) != 0 ? 1.0 : -1.0, (octant & 2U) != 0 ? 1.0 : -1.0,
          (octant & 4U) != 0 ? 1.0 : -1.0};
}

Float4 to_float4(const Vec3& v) {
  return Float4{static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()),
                0.0F};
}

/// What is the same for all pairs of one level. Offsets of the children of a and of b in their
/// parents, in b's mesh frame [m].
struct LevelConstants {
  std::array<DescentScratch::Difference, 8> offset_a;
  std::array<DescentScratch::Difference, 8> offset_b;
  Float4 half_b;  // the size of offset_b in every component [m]
  Float4 limit;   // largest squared distance that passes [m^2], in every component
};

/// Octants o of b with |d - offset_b(o)|^2 <= limit, one bit each.
std::uint32_t octants_within(Float4 d, const LevelConstants& level) {
  const Float4 above = (d + level.half_b) * (d + level.half_b);  // lower octants
  const Float4 below = (d - level.half_b) * (d - level.half_b);  // upper octants
  const Float4 x = __builtin_shufflevector(above, below, 0, 4, 0, 4);
  const Float4 y = __builtin_shufflevector(above, below, 1, 1, 5, 5);
  const Float4 xy = x + y;
  const Float4 lower = level.limit - __builtin_shufflevector(above, above, 2, 2, 2, 2);
  const Float4 upper = level.limit - __builtin_shufflevector(below, below, 2, 2, 2, 2);
  const Int4 hit = ((xy <= lower) & Int4{1, 2, 4, 8}) | ((xy <= upper) & Int4{16, 32, 64, 128});
  const Long2 halves = reinterpret_cast<Long2>(hit);
  const std::int64_t both = halves[0] | halves[1];
  return static_cast<std::uint32_t>(both | (both >> 32));
}

void make_room(Frontier& frontier, std::size_t groups, std::size_t entries) {
  const std::size_t g = frontier.group_count + groups;
  const std::size_t e = frontier.entry_count + entries;
  if (frontier.groups.size() < g) frontier.groups.resize(2 * g);
  if (frontier.b.size() < e) {
    frontier.difference.resize(2 * e);
    frontier.b.resize(2 * e);
  }
}

/// Replaces every pair by its children and keeps those within the limit. Groups stay sorted by a,
/// entries by b, because children follow their parents' order.
std::uint64_t expand(const std::vector<SphereTree::Node>& nodes_a,
                     const std::vector<SphereTree::Node>& nodes_b, const LevelConstants& level,
                     const Frontier& current, Frontier& next) {
  next.group_count = 0;
  next.entry_count = 0;
  std::uint64_t tests = 0;
  for (std::uint32_t g = 0; g < current.group_count; ++g) {
    const Group group = current.groups[g];
    const SphereTree::Node node_a = nodes_a[group.a];
    make_room(next, 8, 64 * static_cast<std::size_t>(group.end - group.begin));
    std::uint64_t children_b = 0;
    for (std::uint32_t e = group.begin; e < group.end; ++e) {
      children_b += kBitCount[nodes_b[current.b[e]].octants];
    }
    tests += kBitCount[node_a.octants] * children_b;

    std::uint32_t child_a = node_a.first_child;
    for (std::uint32_t rest = node_a.octants; rest != 0; rest &= rest - 1, ++child_a) {
      const Float4 offset = level.offset_a[static_cast<std::size_t>(std::countr_zero(rest))].d;
      const std::uint32_t first = next.entry_count;
      std::uint32_t out = first;
      for (std::uint32_t e = group.begin; e < group.end; ++e) {
        const SphereTree::Node node_b = nodes_b[current.b[e]];
        const Float4 d = current.difference[e].d + offset;
        std::uint32_t hit = octants_within(d, level) & node_b.octants;
        for (; hit != 0; hit &= hit - 1, ++out) {
          const auto octant = static_cast<std::uint32_t>(std::countr_zero(hit));
          next.difference[out].d = d - level.offset_b[octant].d;
          next.b[out] = node_b.first_child + kBitCount[node_b.octants & ~(~0U << octant)];
        }
      }
      next.entry_count = out;
      if (out != first) next.groups[next.group_count++] = {child_a, first, out};
    }
  }
  return tests;
}

}  // namespace

void descend(const SphereTree& a, const SphereTree& b, const Pose& X_BA, int level, double margin,
             DescentScratch& scratch, std::vector<SphereOverlap>& out, TestCounts& tests) {
  const voxel::Pyramid& pyramid_a = *a.pyramid;
  const voxel::Pyramid& pyramid_b = *b.pyramid;
  assert(level >= 1 && level <= pyramid_a.max_level() && level <= pyramid_b.max_level());
  out.clear();
  const Mat3 R_BA = X_BA.q.toRotationMatrix();
  const auto reach = [&](int h) {
    return pyramid_a.grid.voxel_radius(h) + pyramid_b.grid.voxel_radius(h) + margin;
  };
  const double slack = kRounding * 2.0 * reach(1);

  const Vec3 difference = X_BA.p + R_BA * a.centers_of(1)[0] - b.centers_of(1)[0];
  ++tests[0];
  if (difference.norm() > reach(1) + slack) return;
  make_room(scratch.current, 1, 1);
  scratch.current.groups[0] = {0, 0, 1};
  scratch.current.difference[0].d = to_float4(difference);
  scratch.current.b[0] = 0;
  scratch.current.group_count = 1;
  scratch.current.entry_count = 1;

  for (int h = 2; h <= level; ++h) {
    LevelConstants constants;
    const double half_a = 0.5 * pyramid_a.grid.voxel_edge(h);
    const double half_b = 0.5 * pyramid_b.grid.voxel_edge(h);
    for (std::uint32_t octant = 0; octant < 8; ++octant) {
      constants.offset_a[octant].d = to_float4(R_BA * (half_a * octant_sign(octant)));
      constants.offset_b[octant].d = to_float4(half_b * octant_sign(octant));
    }
    constants.half_b = Float4{} + static_cast<float>(half_b);
    constants.limit = Float4{} + static_cast<float>((reach(h) + slack) * (reach(h) + slack));
    const auto parent = static_cast<std::size_t>(h) - 2;
    tests[parent + 1] +=
        expand(a.levels[parent], b.levels[parent], constants, scratch.current, scratch.next);
    std::swap(scratch.current, scratch.next);
    if (scratch.current.group_count == 0) return;
  }

  const std::vector<Vec3>& centers_a = a.centers_of(level);
  const std::vector<Vec3>& centers_b = b.centers_of(level);
  const double touching = pyramid_a.grid.voxel_radius(level) + pyramid_b.grid.voxel_radius(level);
  for (std::uint32_t g = 0; g < scratch.current.group_count; ++g) {
    const Group group = scratch.current.groups[g];
    const Vec3 c_A = R_BA * centers_a[group.a] + X_BA.p;
    for (std::uint32_t i = group.begin; i < group.end; ++i) {
      const std::uint32_t voxel_b = scratch.current.b[i];
      const double distance = (c_A - centers_b[voxel_b]).norm();
      if (distance - touching <= margin) out.push_back({group.a, voxel_b, c_A, distance});
    }
  }
}

DescentTrace descend_with_trace(const voxel::Pyramid& a, const voxel::Pyramid& b, const Pose& X_BA,
                                int level, double margin) {
  DescentTrace trace;
  const Mat3 R_BA = X_BA.q.toRotationMatrix();
  std::vector<DescentTrace::VoxelPair> candidates{{0, 0}};
  for (int h = 1; h <= level && !candidates.empty(); ++h) {
    const double inflation = h < level ? 1.0 + 1e-12 : 1.0;
    const double touching = (a.grid.voxel_radius(h) + b.grid.voxel_radius(h)) * inflation;
    trace.tests[static_cast<std::size_t>(h) - 1] = candidates.size();
    std::vector<DescentTrace::VoxelPair>& colliding = trace.colliding.emplace_back();
    for (const DescentTrace::VoxelPair& pair : candidates) {
      const Vec3 c_A = R_BA * a.voxel_center(h, pair.a) + X_BA.p;
      const double distance = (c_A - b.voxel_center(h, pair.b)).norm();
      if (distance - touching <= margin) colliding.push_back(pair);
    }
    std::sort(colliding.begin(), colliding.end());
    candidates.clear();
    if (h == level) break;
    const std::vector<std::uint32_t>& first_a = a.level(h).first_child;
    const std::vector<std::uint32_t>& first_b = b.level(h).first_child;
    for (const DescentTrace::VoxelPair& pair : colliding) {
      for (std::uint32_t i = first_a[pair.a]; i < first_a[pair.a + 1]; ++i) {
        for (std::uint32_t j = first_b[pair.b]; j < first_b[pair.b + 1]; ++j) {
          candidates.push_back({i, j});
        }
      }
    }
  }
  return trace;
}

}  // namespace gotai::collision
