#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "gotai/core/random.h"
#include "gotai/geometry/generators.h"

namespace gotai::geometry::detail {

namespace {

/// A smooth function on the unit sphere with values in [-1, 1]: plane waves with seeded directions
/// and phases. It knows nothing of the mesh, so a rock keeps its form at every fineness.
class SmoothNoise {
 public:
  explicit SmoothNoise(std::uint64_t seed) {
    Random random(seed);
    for (Wave& wave : waves_) {
      const double wave_number = random.uniform(2.0, 5.0);  // drawn first, with every compiler
      wave.k = wave_number * random.unit_vector();
      wave.phase = random.uniform(0.0, 2.0 * std::numbers::pi);
    }
  }
  double operator()(const Vec3& direction) const {
    double sum = 0.0;
    for (const Wave& wave : waves_) sum += std::sin(wave.k.dot(direction) + wave.phase);
    // The sum's deviation is sqrt(kWaves / 2); tanh keeps its rare extremes within [-1, 1].
    return std::tanh(0.6 * sum / std::sqrt(0.5 * kWaves));
  }

 private:
  static constexpr std::size_t kWaves = 8;
  struct Wave {
    Vec3 k;
    double phase;
  };
  std::array<Wave, kWaves> waves_;
};

struct Icosphere {
  std::vector<Vec3> directions;
  std::vector<Triangle> triangles;
};

Icosphere icosahedron() {
  const double g = std::numbers::phi;
  Icosphere s;
  s.directions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                  {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  for (Vec3& d : s.directions) d.normalize();
  s.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                 {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                 {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                 {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  return s;
}

/// Every triangle becomes four, with the new corners on the sphere.
void halve_edges(Icosphere& s) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> midpoints;
  const auto midpoint = [&](std::uint32_t a, std::uint32_t b) {
    const auto [entry, is_new] =
        midpoints.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(s.directions.size()));
    if (is_new) s.directions.push_back((s.directions[a] + s.directions[b]).normalized());
    return entry->second;
  };
  std::vector<Triangle> finer;
  finer.reserve(s.triangles.size() * 4);
  for (const auto& [a, b, c] : s.triangles) {
    const std::uint32_t ab = midpoint(a, b);
    const std::uint32_t bc = midpoint(b, c);
    const std::uint32_t ca = midpoint(c, a);
    finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
  }
  s.triangles = std::move(finer);
}

}  // namespace

Mesh make_rock(int subdivisions, std::uint64_t seed, double roughness) {
  Icosphere sphere = icosahedron();
  for (int i = 0; i < subdivisions; ++i) halve_edges(sphere);
  const SmoothNoise noise(seed);
  Mesh mesh;
  mesh.vertices.reserve(sphere.directions.size() + 1);
  mesh.vertices.push_back(Vec3::Zero());
  for (const Vec3& d : sphere.directions)
    mesh.vertices.push_back(d * (0.5 * (1.0 + roughness * noise(d))));
  mesh.tetrahedra.reserve(sphere.triangles.size());
  for (const auto& [a, b, c] : sphere.triangles)
    mesh.tetrahedra.push_back({0, a + 1, b + 1, c + 1});
  return mesh;
}

}  // namespace gotai::geometry::detail
