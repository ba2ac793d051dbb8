#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "gotai/geometry/edges.h"
#include "gotai/geometry/mesh_report.h"
#include "gotai/geometry/orient.h"
#include "gotai/geometry/tetrahedra.h"

namespace gotai::geometry {

namespace {

/// Relative size below which an area or volume counts as none (round-off of coordinates in single
/// precision would make more of it).
constexpr double kFlat = 1e-12;

template <std::size_t N>
bool has_vertex_twice(std::array<std::uint32_t, N> element) {
  std::ranges::sort(element);
  return std::ranges::adjacent_find(element) != element.end();
}

bool is_flat(const Mesh& mesh, const Triangle& t) {
  const Vec3 ab = mesh.vertices[t[1]] - mesh.vertices[t[0]];
  const Vec3 ac = mesh.vertices[t[2]] - mesh.vertices[t[0]];
  const double longest = std::max({ab.norm(), ac.norm(), (ac - ab).norm()});
  // Divided first, so that tiny coordinates do not underflow.
  return longest == 0.0 || (ab / longest).cross(ac / longest).norm() <= kFlat;
}

bool is_flat(const Mesh& mesh, const Tetrahedron& t) {
  const Vec3 ab = mesh.vertices[t[1]] - mesh.vertices[t[0]];
  const Vec3 ac = mesh.vertices[t[2]] - mesh.vertices[t[0]];
  const Vec3 ad = mesh.vertices[t[3]] - mesh.vertices[t[0]];
  const double longest = std::max({ab.norm(), ac.norm(), ad.norm()});
  return longest == 0.0 || std::abs((ab / longest).cross(ac / longest).dot(ad / longest)) <= kFlat;
}

/// Groups of elements with the same vertices in any order; each group ascending.
template <std::size_t N>
std::vector<std::vector<std::uint32_t>> coincident(
    const std::vector<std::array<std::uint32_t, N>>& elements) {
  std::vector<std::pair<std::array<std::uint32_t, N>, std::uint32_t>> keys;
  keys.reserve(elements.size());
  for (std::uint32_t i = 0; i < elements.size(); ++i) {
    keys.emplace_back(elements[i], i);
    std::ranges::sort(keys.back().first);
  }
  std::ranges::sort(keys);
  std::vector<std::vector<std::uint32_t>> groups;
  for (std::size_t i = 1; i < keys.size(); ++i) {
    if (keys[i].first != keys[i - 1].first) continue;
    if (i == 1 || keys[i - 1].first != keys[i - 2].first) groups.push_back({keys[i - 1].second});
    groups.back().push_back(keys[i].second);
  }
  return groups;
}

template <typename Element>
std::size_t drop(std::vector<Element>& elements, const std::vector<bool>& unwanted) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < elements.size(); ++i)
    if (!unwanted[i]) elements[kept++] = elements[i];
  const std::size_t dropped = elements.size() - kept;
  elements.resize(kept);
  return dropped;
}

/// Drops elements with a vertex twice (they have no neighbours to lose) and counts the flat ones,
/// which stay: without them their neighbours would gape.
template <typename Element>
std::size_t drop_degenerate(Mesh& mesh, std::vector<Element>& elements, std::string_view name,
                            MeshReport& report) {
  std::vector<bool> unwanted(elements.size());
  std::size_t flat = 0;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    unwanted[i] = has_vertex_twice(elements[i]);
    if (!unwanted[i] && is_flat(mesh, elements[i])) ++flat;
  }
  const std::size_t dropped = drop(elements, unwanted);
  if (dropped > 0)
    report.repairs.push_back(fmt::format("dropped {} {} with a vertex twice", dropped, name));
  if (flat > 0)
    report.warnings.push_back(
        fmt::format("{} {} are flat (kept: they hold the mesh together)", flat, name));
  return dropped + flat;
}

std::size_t drop_duplicate_tetrahedra(Mesh& mesh, MeshReport& report) {
  std::vector<bool> unwanted(mesh.tetrahedra.size(), false);
  for (const auto& group : coincident(mesh.tetrahedra))
    for (std::size_t k = 1; k < group.size(); ++k) unwanted[group[k]] = true;
  const std::size_t dropped = drop(mesh.tetrahedra, unwanted);
  if (dropped > 0)
    report.repairs.push_back(
        fmt::format("dropped {} tetrahedra that repeat an earlier one", dropped));
  return dropped;
}

/// Whether two triangles with the same vertices face the same way.
bool same_side(const Triangle& a, const Triangle& b) {
  const auto at = static_cast<std::size_t>(std::ranges::find(b, a[0]) - b.begin());
  return b[(at + 1) % 3] == a[1];
}

/// One side of each two-sided triangle in pieces of the mesh where all triangles are two-sided (the
/// file means a surface seen from both sides); else none (a wall inside a solid, or a fin).
std::size_t drop_two_sided(const Mesh& mesh, const std::vector<std::vector<std::uint32_t>>& groups,
                           std::vector<bool>& unwanted) {
  detail::DisjointSets pieces(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles) {
    pieces.unite(t[0], t[1]);
    pieces.unite(t[0], t[2]);
  }
  std::vector<std::ptrdiff_t> one_sided(mesh.vertices.size(), 0);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    if (!unwanted[i]) ++one_sided[pieces.find(mesh.triangles[i][0])];
  for (const auto& group : groups) one_sided[pieces.find(mesh.triangles[group[0]][0])] -= 2;
  std::size_t dropped = 0;
  for (const auto& group : groups) {
    const bool wall = one_sided[pieces.find(mesh.triangles[group[0]][0])] > 0;
    for (std::size_t k = wall ? 0 : 1; k < 2; ++k, ++dropped) unwanted[group[k]] = true;
  }
  return dropped;
}

/// Coincident triangles. Of those that face the same way one stays. Where as many face one way as
/// the other they cancel: such pairs are walls without thickness, see drop_two_sided().
std::size_t drop_duplicate_triangles(Mesh& mesh, MeshReport& report) {
  std::vector<bool> unwanted(mesh.triangles.size(), false);
  std::vector<std::vector<std::uint32_t>> two_sided;
  std::size_t duplicates = 0;
  for (const auto& group : coincident(mesh.triangles)) {
    duplicates += group.size() - 1;
    std::array<std::vector<std::uint32_t>, 2> sides;
    for (const std::uint32_t t : group)
      sides[same_side(mesh.triangles[group[0]], mesh.triangles[t]) ? 0 : 1].push_back(t);
    for (const std::uint32_t t : group) unwanted[t] = true;
    if (sides[0].size() == sides[1].size()) {
      two_sided.push_back({sides[0][0], sides[1][0]});
      for (const std::uint32_t t : two_sided.back()) unwanted[t] = false;
    } else {
      unwanted[sides[sides[0].size() > sides[1].size() ? 0 : 1][0]] = false;
    }
  }
  const std::size_t walls = drop_two_sided(mesh, two_sided, unwanted);
  const std::size_t dropped = drop(mesh.triangles, unwanted);
  if (dropped > walls)
    report.repairs.push_back(
        fmt::format("dropped {} triangles that repeat an earlier one", dropped - walls));
  if (walls > 0)
    report.repairs.push_back(fmt::format(
        "dropped {} triangles of walls without thickness (two faces back to back)", walls));
  return duplicates;
}

void repair_tetrahedra(Mesh& mesh, MeshReport& report) {
  report.degenerate_tetrahedra = drop_degenerate(mesh, mesh.tetrahedra, "tetrahedra", report);
  report.duplicate_tetrahedra = drop_duplicate_tetrahedra(mesh, report);
  const std::size_t swapped = orient_tetrahedra(mesh);
  // A file may number all its tetrahedra the other way round; that is no defect.
  if (2 * swapped > mesh.tetrahedra.size()) {
    report.inverted_tetrahedra = mesh.tetrahedra.size() - swapped;
    report.repairs.push_back(
        fmt::format("re-oriented {} of {} tetrahedra (the file numbers them "
                    "the other way round)",
                    swapped, mesh.tetrahedra.size()));
  } else if (swapped > 0) {
    report.inverted_tetrahedra = swapped;
    report.repairs.push_back(
        fmt::format("re-oriented {} inverted tetrahedra of {}", swapped, mesh.tetrahedra.size()));
  }
}

}  // namespace

void repair(Mesh& mesh, MeshReport& report) {
  if (mesh.has_tetrahedra()) {
    repair_tetrahedra(mesh, report);
    mesh.triangles = boundary_triangles(mesh.tetrahedra);
    return;
  }
  report.degenerate_triangles = drop_degenerate(mesh, mesh.triangles, "triangles", report);
  report.duplicate_triangles = drop_duplicate_triangles(mesh, report);
  detail::orient_closed_patches(mesh, report.repairs, report.warnings);
}

}  // namespace gotai::geometry
