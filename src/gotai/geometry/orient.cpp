#include "gotai/geometry/orient.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "gotai/geometry/edges.h"

namespace gotai::geometry::detail {

namespace {

constexpr std::uint32_t kNone = static_cast<std::uint32_t>(-1);

struct Patch {
  std::vector<std::uint32_t> triangles;
  bool closed = true;
  bool one_sided = false;
  double volume = 0.0;
  Box3 box;
};

/// Neighbour over each side, and whether it runs the common edge the other way (as it should).
struct Neighbour {
  std::uint32_t triangle = kNone;
  bool agrees = true;
};

struct Surface {
  std::vector<std::array<Neighbour, 3>> neighbours;  // only over edges of two triangles
  std::vector<bool> on_odd_edge;                     // has an edge that is not of two triangles
};

Surface connect(std::span<const Triangle> triangles) {
  Surface surface;
  surface.neighbours.resize(triangles.size());
  surface.on_odd_edge.assign(triangles.size(), false);
  std::vector<std::uint8_t> filled(triangles.size(), 0);
  const std::vector<HalfEdge> sides = sorted_half_edges(triangles);
  for_each_edge(sides, [&](std::span<const HalfEdge> edge) {
    if (edge.size() != 2) {
      for (const HalfEdge& h : edge) surface.on_odd_edge[h.triangle] = true;
      return;
    }
    const bool agrees = edge[0].forward != edge[1].forward;
    const auto add = [&](std::uint32_t from, std::uint32_t to) {
      surface.neighbours[from][filled[from]++] = {to, agrees};
    };
    add(edge[0].triangle, edge[1].triangle);
    add(edge[1].triangle, edge[0].triangle);
  });
  return surface;
}

/// Collects the patch of `seed`; state becomes 1 for triangles that agree with it, 2 for the
/// others.
Patch grow_patch(const Surface& surface, std::uint32_t seed, std::vector<std::uint8_t>& state) {
  constexpr std::uint8_t kKept = 1;
  constexpr std::uint8_t kReversed = 2;
  Patch patch;
  patch.triangles = {seed};
  state[seed] = kKept;
  for (std::size_t next = 0; next < patch.triangles.size(); ++next) {
    const std::uint32_t t = patch.triangles[next];
    if (surface.on_odd_edge[t]) patch.closed = false;
    for (const Neighbour& n : surface.neighbours[t]) {
      if (n.triangle == kNone) continue;
      const std::uint8_t wanted =
          n.agrees ? state[t] : static_cast<std::uint8_t>(kKept + kReversed - state[t]);
      if (state[n.triangle] == 0) {
        state[n.triangle] = wanted;
        patch.triangles.push_back(n.triangle);
      } else if (state[n.triangle] != wanted) {
        patch.one_sided = true;
      }
    }
  }
  return patch;
}

std::size_t make_consistent(Mesh& mesh, const Patch& patch,
                            const std::vector<std::uint8_t>& state) {
  const auto marked = static_cast<std::size_t>(
      std::ranges::count_if(patch.triangles, [&](std::uint32_t t) { return state[t] == 2; }));
  // The file's majority knows which side is out.
  const std::uint8_t minority = 2 * marked > patch.triangles.size() ? 1 : 2;
  std::size_t reversed = 0;
  for (const std::uint32_t t : patch.triangles)
    if (state[t] == minority) {
      std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
      ++reversed;
    }
  return reversed;
}

std::vector<Triangle> triangles_of(const Mesh& mesh, const Patch& patch) {
  std::vector<Triangle> triangles;
  triangles.reserve(patch.triangles.size());
  for (const std::uint32_t t : patch.triangles) triangles.push_back(mesh.triangles[t]);
  return triangles;
}

void measure(const Mesh& mesh, Patch& patch) {
  for (const std::uint32_t t : patch.triangles)
    for (const std::uint32_t v : mesh.triangles[t]) patch.box.extend(mesh.vertices[v]);
  patch.volume = enclosed_volume(mesh.vertices, triangles_of(mesh, patch), patch.box.center());
}

/// Winding number of a patch around a point (Van Oosterom and Strackee 1983).
double winding_number(const Mesh& mesh, const Patch& patch, const Vec3& point) {
  double angle = 0.0;
  for (const std::uint32_t t : patch.triangles) {
    const Vec3 a = mesh.vertices[mesh.triangles[t][0]] - point;
    const Vec3 b = mesh.vertices[mesh.triangles[t][1]] - point;
    const Vec3 c = mesh.vertices[mesh.triangles[t][2]] - point;
    const double la = a.norm();
    const double lb = b.norm();
    const double lc = c.norm();
    angle += 2.0 * std::atan2(a.dot(b.cross(c)),
                              la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return angle / (4.0 * std::numbers::pi);
}

/// @param work  grows by the triangles looked at
bool is_inside(const Mesh& mesh, const Patch& inner, const Patch& outer, std::size_t& work) {
  ++work;
  if (!outer.box.contains(inner.box)) return false;
  work += outer.triangles.size();
  const Triangle& t = mesh.triangles[inner.triangles.front()];
  const Vec3 point = (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.0;
  return std::abs(winding_number(mesh, outer, point)) > 0.5;
}

void turn(Mesh& mesh, Patch& patch) {
  for (const std::uint32_t t : patch.triangles)
    std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  patch.volume = -patch.volume;
}

struct Turned {
  std::size_t patches = 0;
  std::size_t unchecked = 0;  ///< left alone, because the search for what is around them took long
};

/// Turns inside-out patches. Patches are visited from the largest to the smallest, so that those
/// around a patch are right when it is its turn.
Turned turn_outward(Mesh& mesh, std::vector<Patch>& patches) {
  /// Patches in patches take time like the square of their number; this is about half a second.
  constexpr std::size_t kMostWork = 5'000'000;
  std::ranges::stable_sort(patches, [](const Patch& a, const Patch& b) {
    return std::abs(a.volume) > std::abs(b.volume);
  });
  std::size_t work = 0;
  std::size_t turned = 0;
  std::vector<bool> was_turned(patches.size(), false);
  for (std::size_t i = 0; i < patches.size(); ++i) {
    if (work > kMostWork) return {turned, patches.size() - i};
    std::size_t around = 0;
    bool around_turned = false;
    for (std::size_t j = 0; j < i; ++j)
      if (is_inside(mesh, patches[i], patches[j], work)) {
        ++around;
        around_turned |= was_turned[j];
      }
    const bool hollow = around % 2 == 1;
    const bool wrong = hollow ? around_turned && patches[i].volume > 0.0 : patches[i].volume < 0.0;
    if (!wrong) continue;
    turn(mesh, patches[i]);
    was_turned[i] = true;
    ++turned;
  }
  return {turned, 0};
}

}  // namespace

void orient_closed_patches(Mesh& mesh, std::vector<std::string>& repairs,
                           std::vector<std::string>& warnings) {
  const Surface surface = connect(mesh.triangles);
  std::vector<std::uint8_t> state(mesh.triangles.size(), 0);
  std::vector<Patch> closed;
  std::size_t reversed = 0;
  std::size_t one_sided = 0;
  for (std::uint32_t seed = 0; seed < mesh.triangles.size(); ++seed) {
    if (state[seed] != 0) continue;
    Patch patch = grow_patch(surface, seed, state);
    if (patch.one_sided) ++one_sided;
    if (!patch.closed || patch.one_sided) continue;
    reversed += make_consistent(mesh, patch, state);
    measure(mesh, patch);
    closed.push_back(std::move(patch));
  }
  if (reversed > 0)
    repairs.push_back(
        fmt::format("reversed {} triangles that disagreed with their neighbours", reversed));
  if (one_sided > 0)
    warnings.push_back(
        fmt::format("{} pieces of the surface have only one side and cannot be "
                    "oriented",
                    one_sided));
  const std::size_t pieces = closed.size();
  const Turned turned = turn_outward(mesh, closed);
  if (turned.patches > 0)
    repairs.push_back(
        fmt::format("turned {} of {} closed pieces that were inside out", turned.patches, pieces));
  if (turned.unchecked > 0)
    warnings.push_back(fmt::format("{} of {} closed pieces were not checked for being inside out",
                                   turned.unchecked, pieces));
}

}  // namespace gotai::geometry::detail
