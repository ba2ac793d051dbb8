#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

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

/// Marks the elements whose vertices an earlier element has, in any order.
template <std::size_t N>
std::vector<bool> duplicates(const std::vector<std::array<std::uint32_t, N>>& elements) {
  std::vector<std::pair<std::array<std::uint32_t, N>, std::size_t>> keys;
  keys.reserve(elements.size());
  for (std::size_t i = 0; i < elements.size(); ++i) {
    keys.emplace_back(elements[i], i);
    std::ranges::sort(keys.back().first);
  }
  std::ranges::sort(keys);
  std::vector<bool> duplicate(elements.size(), false);
  for (std::size_t i = 1; i < keys.size(); ++i)
    if (keys[i].first == keys[i - 1].first) duplicate[keys[i].second] = true;
  return duplicate;
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

template <typename Element>
std::size_t drop_duplicates(std::vector<Element>& elements, std::string_view name,
                            MeshReport& report) {
  const std::size_t dropped = drop(elements, duplicates(elements));
  if (dropped > 0)
    report.repairs.push_back(
        fmt::format("dropped {} {} that repeat an earlier one", dropped, name));
  return dropped;
}

void repair_tetrahedra(Mesh& mesh, MeshReport& report) {
  report.degenerate_tetrahedra = drop_degenerate(mesh, mesh.tetrahedra, "tetrahedra", report);
  report.duplicate_tetrahedra = drop_duplicates(mesh.tetrahedra, "tetrahedra", report);
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
  report.duplicate_triangles = drop_duplicates(mesh.triangles, "triangles", report);
  detail::orient_closed_patches(mesh, report.repairs, report.warnings);
}

}  // namespace gotai::geometry
