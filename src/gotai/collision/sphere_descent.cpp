#include "gotai/collision/sphere_descent.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>

namespace gotai::collision {

namespace {

using Entry = DescentScratch::Entry;
using Group = DescentScratch::Group;
using Frontier = DescentScratch::Frontier;
using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));

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

/// What is the same for all pairs of one level.
struct LevelConstants {
  std::array<std::array<float, 3>, 8> offset_a;  // a's child in its parent, b's mesh frame [m]
  float half_b;                                  // half edge of b's child: its offset per axis [m]
  float limit;                                   // largest squared distance that passes [m^2]
};

/// Octants o of b whose centre is within the limit: d = (x, y, z) - offset(o), |d|^2 <= limit.
std::uint32_t octants_within(float x, float y, float z, float half, float limit) {
  const Float4 dx = Float4{x, x, x, x} + Float4{half, -half, half, -half};
  const Float4 dy = Float4{y, y, y, y} + Float4{half, half, -half, -half};
  const Float4 xy = dx * dx + dy * dy;
  const float low = limit - (z + half) * (z + half);
  const float high = limit - (z - half) * (z - half);
  Int4 hit = (xy <= Float4{low, low, low, low}) & Int4{1, 2, 4, 8};
  hit |= (xy <= Float4{high, high, high, high}) & Int4{16, 32, 64, 128};
  return static_cast<std::uint32_t>(hit[0] | hit[1] | hit[2] | hit[3]);
}

void make_room(Frontier& frontier, std::size_t groups, std::size_t entries) {
  const std::size_t g = frontier.group_count + groups;
  const std::size_t e = frontier.entry_count + entries;
  if (frontier.groups.size() < g) frontier.groups.resize(2 * g);
  if (frontier.entries.size() < e) frontier.entries.resize(2 * e);
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
    const Entry* const begin = current.entries.data() + group.begin;
    const Entry* const end = current.entries.data() + group.end;
    make_room(next, 8, 64 * static_cast<std::size_t>(end - begin));
    std::uint64_t children_b = 0;
    for (const Entry* e = begin; e != end; ++e) children_b += kBitCount[nodes_b[e->b].octants];
    tests += kBitCount[node_a.octants] * children_b;

    std::uint32_t child_a = node_a.first_child;
    for (std::uint32_t rest = node_a.octants; rest != 0; rest &= rest - 1, ++child_a) {
      const std::array<float, 3>& offset =
          level.offset_a[static_cast<std::size_t>(std::countr_zero(rest))];
      const std::uint32_t first = next.entry_count;
      Entry* out = next.entries.data() + first;
      for (const Entry* e = begin; e != end; ++e) {
        const SphereTree::Node node_b = nodes_b[e->b];
        const float x = e->x + offset[0];
        const float y = e->y + offset[1];
        const float z = e->z + offset[2];
        std::uint32_t hit = octants_within(x, y, z, level.half_b, level.limit) & node_b.octants;
        for (; hit != 0; hit &= hit - 1) {
          const auto octant = static_cast<std::uint32_t>(std::countr_zero(hit));
          out->x = (octant & 1U) != 0 ? x - level.half_b : x + level.half_b;
          out->y = (octant & 2U) != 0 ? y - level.half_b : y + level.half_b;
          out->z = (octant & 4U) != 0 ? z - level.half_b : z + level.half_b;
          out->b = node_b.first_child + kBitCount[node_b.octants & ((1U << octant) - 1)];
          ++out;
        }
      }
      next.entry_count = static_cast<std::uint32_t>(out - next.entries.data());
      if (next.entry_count != first) {
        next.groups[next.group_count++] = {child_a, first, next.entry_count};
      }
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

  const Vec3 difference =
      X_BA.p + R_BA * pyramid_a.level(1).center[0] - pyramid_b.level(1).center[0];
  ++tests[0];
  if (difference.norm() > reach(1) + slack) return;
  make_room(scratch.current, 1, 1);
  scratch.current.groups[0] = {0, 0, 1};
  scratch.current.entries[0] = {static_cast<float>(difference.x()),
                                static_cast<float>(difference.y()),
                                static_cast<float>(difference.z()), 0};
  scratch.current.group_count = 1;
  scratch.current.entry_count = 1;

  for (int h = 2; h <= level; ++h) {
    LevelConstants constants;
    const double half_a = 0.5 * pyramid_a.grid.voxel_edge(h);
    for (std::uint32_t octant = 0; octant < 8; ++octant) {
      const Vec3 offset = R_BA * (half_a * octant_sign(octant));
      constants.offset_a[octant] = {static_cast<float>(offset.x()), static_cast<float>(offset.y()),
                                    static_cast<float>(offset.z())};
    }
    constants.half_b = static_cast<float>(0.5 * pyramid_b.grid.voxel_edge(h));
    constants.limit = static_cast<float>((reach(h) + slack) * (reach(h) + slack));
    const auto parent = static_cast<std::size_t>(h) - 2;
    tests[parent + 1] +=
        expand(a.levels[parent], b.levels[parent], constants, scratch.current, scratch.next);
    std::swap(scratch.current, scratch.next);
    if (scratch.current.group_count == 0) return;
  }

  const std::vector<Vec3>& centers_a = pyramid_a.level(level).center;
  const std::vector<Vec3>& centers_b = pyramid_b.level(level).center;
  const double touching = pyramid_a.grid.voxel_radius(level) + pyramid_b.grid.voxel_radius(level);
  for (std::uint32_t g = 0; g < scratch.current.group_count; ++g) {
    const Group group = scratch.current.groups[g];
    const Vec3 c_A = R_BA * centers_a[group.a] + X_BA.p;
    for (std::uint32_t i = group.begin; i < group.end; ++i) {
      const std::uint32_t voxel_b = scratch.current.entries[i].b;
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
      const Vec3 c_A = R_BA * a.level(h).center[pair.a] + X_BA.p;
      const double distance = (c_A - b.level(h).center[pair.b]).norm();
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
