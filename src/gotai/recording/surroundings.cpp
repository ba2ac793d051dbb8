#include "gotai/recording/surroundings.h"

#include <algorithm>
#include <utility>

namespace gotai::recording {

geometry::Mesh plane_square(double half_edge) {
  const double h = half_edge;
  return {{{-h, -h, 0}, {h, -h, 0}, {h, h, 0}, {-h, h, 0}}, {{0, 1, 2}, {0, 2, 3}}, {}};
}

geometry::Mesh container_walls(const Vec3& half_extent) {
  geometry::Mesh mesh;
  for (const double z : {0.0, half_extent.z()}) {
    for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
      mesh.vertices.emplace_back(x * half_extent.x(), y * half_extent.y(), z);
    }
  }
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  for (std::uint32_t i = 0; i < 4; ++i) {
    const std::uint32_t j = (i + 1) % 4;
    mesh.triangles.push_back({i, i + 4, j + 4});
    mesh.triangles.push_back({i, j + 4, j});
  }
  return mesh;
}

double plane_half_edge(const RecordingReader& recording) {
  double far = 1.0;
  for (std::size_t f = 0; f < recording.frame_count(); ++f) {
    const Frame frame = recording.frame(f);
    for (const Pose& X : frame.poses) {
      if (X.p.allFinite()) far = std::max(far, X.p.cwiseAbs().maxCoeff());
    }
  }
  return 1.5 * far;
}

geometry::Mesh drawing_of(const RecordingReader& recording, std::size_t body, double plane_edge) {
  const RecordedBody& b = recording.bodies()[body];
  switch (b.geometry) {
    case model::Geometry::plane:
      return plane_square(plane_edge);
    case model::Geometry::container:
      return container_walls(b.half_extent);
    case model::Geometry::shape:
      break;
  }
  return recording.shapes()[b.shape].mesh;
}

}  // namespace gotai::recording
