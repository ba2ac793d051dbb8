// Verdicts from final poses alone, the same for every engine.
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "gotai/geometry/mass_properties.h"
#include "pile/pile.h"

namespace gotai::pile {
namespace {

// A ring's centre line in the mesh frame: a circle about the thinnest axis of the box.
struct Ring {
  Vec3 centre = Vec3::Zero(), axis = Vec3::Zero();
  double radius = 0.0;
};

Ring centre_line(const geometry::Mesh& mesh) {
  const Box3 box = geometry::bounding_box(mesh);
  const Vec3 extent = box.sizes();
  int thin = 0;
  extent.minCoeff(&thin);
  Ring ring;
  ring.centre = box.center();
  ring.axis[thin] = 1.0;
  ring.radius = 0.5 * (extent.maxCoeff() - extent[thin]);
  return ring;
}

Ring moved(const Ring& ring, const Pose& X) {
  return {X * ring.centre, X.q * ring.axis, ring.radius};
}

// Two circles are linked when one passes the other's disc an odd number of times.
bool are_linked(const Ring& a, const Ring& b) {
  if ((a.centre - b.centre).norm() > a.radius + b.radius) return false;
  const Vec3 u = b.axis.unitOrthogonal();
  const Vec3 v = b.axis.cross(u);
  constexpr int kPoints = 720;
  bool linked = false;
  Vec3 before = b.centre + b.radius * u;
  for (int k = 1; k <= kPoints; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / kPoints;
    const Vec3 x = b.centre + b.radius * (std::cos(angle) * u + std::sin(angle) * v);
    const double height_before = a.axis.dot(before - a.centre);
    const double height = a.axis.dot(x - a.centre);
    if ((height_before < 0.0) != (height < 0.0)) {
      const Vec3 crossing = before + (x - before) * (height_before / (height_before - height));
      if ((crossing - a.centre).norm() < a.radius) linked = !linked;
    }
    before = x;
  }
  return linked;
}

int count_links(const Ring& ring, const std::vector<Pose>& poses) {
  int count = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Ring a = moved(ring, poses[i]);
    for (std::size_t j = 0; j < i; ++j) count += are_linked(a, moved(ring, poses[j])) ? 1 : 0;
  }
  return count;
}

}  // namespace

void judge(const Pile& pile, Result& result) {
  // A world only to hold the poses; its collision model is not asked.
  World world{model::Settings{}};
  const auto shape = world.add_shape(std::make_shared<const voxel::Shape>(
      voxel::make_shape("judge", pile.mesh, {.prepared_level = 6, .surface_level = 0})));
  world.add_container({.name = "container", .inner = pile.inner});
  for (const Pose& X : result.poses) {
    BodyDescription body;
    body.shape = shape;
    body.X_WM = X;
    world.add_body(body);
  }
  result.overlap = measure_true_overlap(world.bodies(), world.shapes());
  const Ring ring = centre_line(pile.mesh);
  result.linked = count_links(ring, result.poses) - count_links(ring, pile.poses);
  for (model::BodyIndex i = 1; i < world.bodies().size(); ++i) {
    const Vec3& x = world.bodies().x_W[i];
    const bool inside = x.z() > 0.0 && std::abs(x.x()) < 0.5 * pile.inner.x() &&
                        std::abs(x.y()) < 0.5 * pile.inner.y();
    if (!inside) ++result.escaped;
  }
}

}  // namespace gotai::pile
