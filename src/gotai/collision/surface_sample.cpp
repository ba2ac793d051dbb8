#include "gotai/collision/surface_sample.h"

#include <algorithm>
#include <cmath>

namespace gotai::collision {

Vec3 sample_point(const voxel::SurfaceModel& model, std::uint32_t sample) {
  const voxel::PointPacket& packet = model.tree.points[sample / voxel::kLanes];
  const std::uint32_t lane = sample % voxel::kLanes;
  return model.center + Vec3(packet.x[lane], packet.y[lane], packet.z[lane]);
}

double facing_area(const voxel::SurfaceModel& model, std::uint32_t sample, const Vec3& toward) {
  return std::max(to_double(model.tree.vector_area(sample)).dot(toward),
                  1e-3 * model.spacing * model.spacing);
}

Vec3 fit_to_normal_cone(const voxel::SurfaceTree& tree, std::uint32_t sample, const Vec3& toward) {
  // More than 89 degrees from every normal: the surface lies along the other body, not against it.
  constexpr double kGrazing = 0.0175;
  const voxel::SurfaceElement& element = tree.elements[sample];
  const voxel::SampleEdge* edge = tree.edge_of(sample);
  const Vec3 axis = to_double(unit_normal(element));
  const double cosine = static_cast<double>(element.cone_cosine);
  // Most samples of flat faces have one normal.
  if (cosine >= 1.0 && edge == nullptr) {
    return toward.dot(axis) <= kGrazing ? Vec3(Vec3::Zero()) : axis;
  }
  const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
  Vec3 d = toward;
  if (edge != nullptr) {
    // Normals of an edge are perpendicular to it.
    const Vec3 along = to_double(edge->direction).normalized();
    d -= d.dot(along) * along;
    const double length = d.norm();
    if (length < 1e-6) return Vec3::Zero();
    d /= length;
  }
  const double along_axis = d.dot(axis);
  if (along_axis >= cosine) return d;
  if (along_axis <= kGrazing - sine) return Vec3::Zero();
  const Vec3 across = d - along_axis * axis;
  return cosine * axis + (sine / across.norm()) * across;
}

}  // namespace gotai::collision
