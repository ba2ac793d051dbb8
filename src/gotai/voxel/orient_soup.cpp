#include "gotai/voxel/orient_soup.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "gotai/core/parallel.h"
#include "gotai/core/random.h"
#include "gotai/geometry/edges.h"
#include "gotai/geometry/mesh_report.h"
#include "gotai/voxel/winding_tree.h"

namespace gotai::voxel {
namespace {

using geometry::Mesh;
using geometry::Triangle;

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

Vec3 area_vector(const Mesh& mesh, const Triangle& t) {
  const Vec3& a = mesh.vertices[t[0]];
  return 0.5 * (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a);
}

/// Drops triangles without area and all but the first of those with the same vertices.
std::size_t drop_degenerate_and_duplicate(Mesh& mesh) {
  std::vector<std::pair<Triangle, std::uint32_t>> keys;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (area_vector(mesh, mesh.triangles[t]).squaredNorm() == 0.0) continue;
    Triangle sorted = mesh.triangles[t];
    std::sort(sorted.begin(), sorted.end());
    keys.emplace_back(sorted, t);
  }
  std::sort(keys.begin(), keys.end());
  const auto same = [](const auto& p, const auto& q) { return p.first == q.first; };
  const auto last = std::unique(keys.begin(), keys.end(), same);
  const auto duplicates = static_cast<std::size_t>(keys.end() - last);
  keys.erase(last, keys.end());
  std::sort(keys.begin(), keys.end(),
            [](const auto& p, const auto& q) { return p.second < q.second; });
  std::vector<Triangle> kept;
  kept.reserve(keys.size());
  for (const auto& key : keys) kept.push_back(mesh.triangles[key.second]);
  mesh.triangles = std::move(kept);
  return duplicates;
}

/// The triangle across each side, over edges of exactly two triangles.
struct Neighbours {
  std::array<std::uint32_t, 3> triangle{kNone, kNone, kNone};
  std::array<bool, 3> agrees{true, true, true};  ///< runs the edge the other way, as it should
  std::size_t count = 0;

  void add(std::uint32_t t, bool agree) {
    triangle[count] = t;
    agrees[count++] = agree;
  }
};

std::vector<Neighbours> find_neighbours(const Mesh& mesh) {
  std::vector<Neighbours> neighbours(mesh.triangles.size());
  const auto sides = geometry::detail::sorted_half_edges(mesh.triangles);
  geometry::detail::for_each_edge(sides, [&](std::span<const geometry::detail::HalfEdge> edge) {
    if (edge.size() != 2) return;
    const bool agree = edge[0].forward != edge[1].forward;
    neighbours[edge[0].triangle].add(edge[1].triangle, agree);
    neighbours[edge[1].triangle].add(edge[0].triangle, agree);
  });
  return neighbours;
}

/// Triangles joined by edges, with their sides made to agree.
struct Patch {
  std::vector<std::uint32_t> triangles;
  double majority = 0.0;  ///< area that kept its side minus area turned, per area: 1 if all agree
};

Patch grow_patch(Mesh& mesh, const std::vector<Neighbours>& neighbours, std::uint32_t seed,
                 std::vector<bool>& visited, std::vector<bool>& turned) {
  Patch patch;
  patch.triangles = {seed};
  visited[seed] = true;
  double kept_area = 0.0;
  double turned_area = 0.0;
  for (std::size_t next = 0; next < patch.triangles.size(); ++next) {
    const std::uint32_t t = patch.triangles[next];
    (turned[t] ? turned_area : kept_area) += area_vector(mesh, mesh.triangles[t]).norm();
    for (std::size_t k = 0; k < neighbours[t].count; ++k) {
      const std::uint32_t n = neighbours[t].triangle[k];
      if (visited[n]) continue;
      visited[n] = true;
      turned[n] = neighbours[t].agrees[k] == turned[t];
      patch.triangles.push_back(n);
    }
  }
  // The majority knows best: turn the others.
  if (turned_area > kept_area) {
    for (const std::uint32_t t : patch.triangles) turned[t] = !turned[t];
    std::swap(turned_area, kept_area);
  }
  patch.majority = (kept_area - turned_area) / (kept_area + turned_area);
  return patch;
}

/// A direction around a normal with density cosine / pi.
Vec3 cosine_direction(const Vec3& normal, Random& random) {
  return (normal + (1.0 - 1e-6) * random.unit_vector()).normalized();
}

/// What rays from both sides of a patch met.
struct Views {
  int rays = 0;
  int front_free = 0;  ///< the front saw infinity and the back did not
  int back_free = 0;
  int parity = 0;  ///< rays whose hits say "front is outside" minus those that say the opposite
};

Views look_around(const Mesh& mesh, const WindingTree& tree, const Patch& patch, int rays) {
  // Triangles in proportion to their area, evenly spread.
  std::vector<double> cumulative;
  double total = 0.0;
  for (const std::uint32_t t : patch.triangles)
    cumulative.push_back(total += area_vector(mesh, mesh.triangles[t]).norm());
  Random random(patch.triangles.front());
  Views views;
  views.rays = rays;
  for (int i = 0; i < rays; ++i) {
    const double at = (i + random.uniform()) / rays * total;
    const auto pick = static_cast<std::size_t>(
        std::lower_bound(cumulative.begin(), cumulative.end() - 1, at) - cumulative.begin());
    const std::uint32_t t = patch.triangles[pick];
    const Triangle& corners = mesh.triangles[t];
    double u = random.uniform();
    double v = random.uniform();
    if (u + v > 1.0) {
      u = 1.0 - u;
      v = 1.0 - v;
    }
    const Vec3& a = mesh.vertices[corners[0]];
    const Vec3 from = a + u * (mesh.vertices[corners[1]] - a) + v * (mesh.vertices[corners[2]] - a);
    const Vec3 normal = area_vector(mesh, corners).normalized();
    const int front = tree.count_hits(from, cosine_direction(normal, random), t);
    const int back = tree.count_hits(from, cosine_direction(-normal, random), t);
    if (front == 0 && back > 0) ++views.front_free;
    if (back == 0 && front > 0) ++views.back_free;
    if (front % 2 != back % 2) views.parity += front % 2 == 0 ? 1 : -1;
  }
  return views;
}

/// Whether the views of a patch say that it is inside out.
bool is_inside_out(const Views& views, double majority) {
  const int free = views.front_free + views.back_free;
  const int difference = views.front_free - views.back_free;
  // Rays that leak through holes are rare and come from both sides.
  if (20 * free >= views.rays && 2 * std::abs(difference) >= free) return difference < 0;
  if (majority >= 0.5) return false;
  return views.parity < 0;
}

}  // namespace

OrientedSoup orient_soup(const geometry::Mesh& mesh) {
  OrientedSoup soup;
  soup.mesh.vertices = mesh.vertices;
  soup.mesh.triangles = mesh.triangles;
  geometry::weld(soup.mesh);
  soup.duplicates = drop_degenerate_and_duplicate(soup.mesh);

  std::vector<Triangle>& triangles = soup.mesh.triangles;
  const std::vector<Neighbours> neighbours = find_neighbours(soup.mesh);
  std::vector<bool> visited(triangles.size(), false);
  std::vector<bool> turned(triangles.size(), false);
  std::vector<Patch> patches;
  for (std::uint32_t seed = 0; seed < triangles.size(); ++seed)
    if (!visited[seed]) patches.push_back(grow_patch(soup.mesh, neighbours, seed, visited, turned));
  for (std::size_t t = 0; t < triangles.size(); ++t)
    if (turned[t]) std::swap(triangles[t][1], triangles[t][2]);

  const WindingTree tree(soup.mesh);
  // A soup of single triangles gets few rays for each, a few patches get many.
  const int rays = static_cast<int>(
      std::clamp<std::size_t>(100'000 / std::max<std::size_t>(patches.size(), 1), 8, 512));
  std::vector<std::uint8_t> inside_out(patches.size(), 0);
  parallel_for(patches.size(), 8, [&](std::size_t p) {
    const Views views = look_around(soup.mesh, tree, patches[p], rays);
    inside_out[p] = is_inside_out(views, patches[p].majority) ? 1 : 0;
  });
  for (std::size_t p = 0; p < patches.size(); ++p) {
    if (inside_out[p] == 0) continue;
    for (const std::uint32_t t : patches[p].triangles) {
      std::swap(triangles[t][1], triangles[t][2]);
      turned[t] = !turned[t];
    }
  }
  soup.patches = patches.size();
  soup.reversed = static_cast<std::size_t>(std::count(turned.begin(), turned.end(), true));
  return soup;
}

}  // namespace gotai::voxel
