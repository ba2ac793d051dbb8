#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "gotai/core/error.h"
#include "gotai/geometry/edges.h"
#include "gotai/geometry/mesh_report.h"
#include "gotai/geometry/self_intersections.h"
#include "gotai/geometry/tetrahedra.h"

namespace gotai::geometry {

namespace {

void count_edges(const Mesh& mesh, MeshReport& report) {
  const std::vector<detail::HalfEdge> sides = detail::sorted_half_edges(mesh.triangles);
  bool twice_the_same_way = false;
  bool balanced = true;
  detail::for_each_edge(sides, [&](std::span<const detail::HalfEdge> edge) {
    const auto forward = static_cast<std::size_t>(
        std::ranges::count_if(edge, [](const detail::HalfEdge& h) { return h.forward; }));
    const std::size_t backward = edge.size() - forward;
    if (edge.size() == 1) ++report.boundary_edges;
    if (edge.size() > 2) ++report.non_manifold_edges;
    if (edge.size() == 2 && forward != 1) ++report.misoriented_edges;
    twice_the_same_way |= forward > 1 || backward > 1;
    balanced &= forward == backward;
  });
  report.closed = !sides.empty() && report.boundary_edges == 0 && report.non_manifold_edges == 0;
  report.oriented = !twice_the_same_way;
  report.balanced = !sides.empty() && balanced;
}

std::size_t count_components(const Mesh& mesh) {
  detail::DisjointSets sets(mesh.vertices.size());
  std::vector<bool> used(mesh.vertices.size(), false);
  const auto join = [&](const auto& element) {
    for (const std::uint32_t v : element) {
      used[v] = true;
      sets.unite(element[0], v);
    }
  };
  for (const Triangle& t : mesh.triangles) join(t);
  for (const Tetrahedron& t : mesh.tetrahedra) join(t);
  std::size_t components = 0;
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v)
    if (used[v] && sets.find(v) == v) ++components;
  return components;
}

double volume_of(const Mesh& mesh, const Box3& box) {
  if (!mesh.has_tetrahedra())
    return detail::enclosed_volume(mesh.vertices, mesh.triangles, box.center());
  double volume = 0.0;
  for (const Tetrahedron& tet : mesh.tetrahedra) volume += signed_volume(mesh, tet);
  return volume;
}

/// A used vertex by its position.
struct Key {
  std::array<double, 3> position;
  std::uint32_t vertex;
};

template <typename Element>
void validate_elements(const Mesh& mesh, const std::vector<Element>& elements,
                       std::string_view name) {
  for (std::size_t i = 0; i < elements.size(); ++i)
    for (const std::uint32_t v : elements[i]) {
      if (v >= mesh.vertices.size())
        throw InvalidArgument(
            fmt::format("{} {}", name, i), fmt::format("vertex {}", v),
            fmt::format("must be below the number of vertices, {}", mesh.vertices.size()));
      if (!mesh.vertices[v].allFinite())
        throw InvalidArgument(fmt::format("vertex {}", v),
                              fmt::format("({}, {}, {})", mesh.vertices[v].x(),
                                          mesh.vertices[v].y(), mesh.vertices[v].z()),
                              "must be finite");
    }
}

}  // namespace

MeshReport inspect(const Mesh& mesh) {
  MeshReport report;
  report.vertices = mesh.vertices.size();
  report.triangles = mesh.triangles.size();
  report.tetrahedra = mesh.tetrahedra.size();
  count_edges(mesh, report);
  report.components = count_components(mesh);
  const Box3 box = bounding_box(mesh);
  if (!box.isEmpty()) {
    report.extents = box.sizes();
    report.volume = volume_of(mesh, box);
  }
  const SelfIntersections crossings = find_self_intersections(mesh);
  report.self_intersections = crossings.pairs;
  report.self_intersections_complete = crossings.complete;
  return report;
}

void validate(const Mesh& mesh) {
  validate_elements(mesh, mesh.triangles, "triangle");
  validate_elements(mesh, mesh.tetrahedra, "tetrahedron");
}

std::size_t weld(Mesh& mesh) {
  constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
  // Used vertices in the order of first use.
  std::vector<std::uint32_t> order;
  std::vector<bool> used(mesh.vertices.size(), false);
  const auto collect = [&](const auto& elements) {
    for (const auto& element : elements)
      for (const std::uint32_t v : element)
        if (!used[v]) {
          used[v] = true;
          order.push_back(v);
        }
  };
  collect(mesh.triangles);
  collect(mesh.tetrahedra);

  // Rank them by position; equal positions become neighbours, the first used one first.
  std::vector<Key> keys;
  keys.reserve(order.size());
  for (std::uint32_t rank = 0; rank < order.size(); ++rank) {
    const Vec3 p = mesh.vertices[order[rank]] + Vec3::Zero();  // -0.0 + 0.0 = 0.0
    keys.push_back({{p.x(), p.y(), p.z()}, rank});
  }
  std::ranges::sort(keys, [](const Key& a, const Key& b) {
    return a.position != b.position ? a.position < b.position : a.vertex < b.vertex;
  });
  std::vector<std::uint32_t> representative(order.size());
  for (std::size_t i = 0; i < keys.size(); ++i)
    representative[keys[i].vertex] = i > 0 && keys[i].position == keys[i - 1].position
                                         ? representative[keys[i - 1].vertex]
                                         : keys[i].vertex;

  std::vector<std::uint32_t> target(mesh.vertices.size(), kUnused);
  std::vector<Vec3> vertices;
  for (std::uint32_t rank = 0; rank < order.size(); ++rank) {
    const std::uint32_t first = order[representative[rank]];
    if (target[first] == kUnused) {
      target[first] = static_cast<std::uint32_t>(vertices.size());
      vertices.push_back(mesh.vertices[first]);
    }
    target[order[rank]] = target[first];
  }
  const std::size_t merged = order.size() - vertices.size();
  mesh.vertices = std::move(vertices);
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t) v = target[v];
  for (Tetrahedron& t : mesh.tetrahedra)
    for (std::uint32_t& v : t) v = target[v];
  return merged;
}

}  // namespace gotai::geometry
