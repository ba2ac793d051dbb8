#include "gotai/collision/surface_faces.h"

#include <array>
#include <cmath>

#include "gotai/collision/face.h"
#include "gotai/collision/relative_pose.h"
#include "gotai/collision/surface_sample.h"

namespace gotai::collision {
namespace {

using model::BodyIndex;
using model::BodyState;
using Shapes = std::span<const std::shared_ptr<const voxel::Shape>>;

// Samples of body a above the faces of body b.
class SamplesAboveFaces {
 public:
  SamplesAboveFaces(const BodyState& bodies, const BodyPair& pair, Shapes shapes,
                    const CurvedSamples* curved)
      : bodies_(bodies),
        a_(pair.body_a),
        b_(pair.body_b),
        model_(shapes[bodies.shape[pair.body_a]]->surface),
        X_UA_(relative_pose({bodies.x_W[pair.body_b], bodies.q_WB[pair.body_b]},
                            bodies.mesh_pose(pair.body_a))),
        R_UA_(X_UA_.q.toRotationMatrix()),
        curved_(curved) {}

  void append_plane(double margin, const PairMotion& motion, SurfaceScratch& scratch) const {
    append(floor_face(), 0, margin, motion, scratch, [](const Vec3&) { return true; });
  }

  // Faces of the open-top box: they act below its rim, and only on bodies whose centre is inside or
  // points that are.
  void append_container(double margin, const PairMotion& motion, SurfaceScratch& scratch) const {
    const Vec3 half = bodies_.half_extent[b_];
    const auto above_floor_area = [&half](const Vec3& p_U) {
      return std::abs(p_U.x()) <= half.x() && std::abs(p_U.y()) <= half.y();
    };
    const bool body_inside =
        above_floor_area(bodies_.q_WB[b_].conjugate() * (bodies_.x_W[a_] - bodies_.x_W[b_]));
    const auto acts = [&](const Vec3& p_U) { return body_inside || above_floor_area(p_U); };
    append(floor_face(), 0, margin, motion, scratch, acts);
    const std::array<Face, 4> walls = container_walls(half);
    for (std::uint32_t w = 0; w < walls.size(); ++w) {
      append(walls[w], w + 1, margin, motion, scratch,
             [&](const Vec3& p_U) { return p_U.z() <= half.z() && acts(p_U); });
    }
  }

 private:
  // @param acts  (point in U): does the face act on it?
  template <typename Acts>
  void append(const Face& face, std::uint32_t index, double margin, const PairMotion& motion,
              SurfaceScratch& scratch, const Acts& acts) const {
    const Vec3 n_A = R_UA_.transpose() * face.normal;
    const double offset = face.normal.dot(X_UA_.p) + face.offset;
    const Eigen::Vector3f n = n_A.cast<float>();
    // Heights are searched in single precision with room to spare, then computed in double.
    const double slack = 1e-5 * (model_.edge + std::abs(offset));
    search_half_space(model_.tree, {n.x(), n.y(), n.z()},
                      static_cast<float>(offset + n_A.dot(model_.center)),
                      static_cast<float>(margin + slack), scratch.search);
    for (const SurfaceHit& hit : scratch.search.hits) {
      Vec3 x_A = sample_point(model_, hit.sample);
      if (const CurvedSample* bent = curved_ == nullptr ? nullptr : curved_->find(hit.sample)) {
        const Eigen::Vector2d slide = slide_to_face(*bent, -n_A);
        const bool is_near = slide.norm() <= curved_->reach();
        if (!is_near && hit.distance > 0.0F) continue;
        if (is_near) x_A = model_.center + slid_point(*bent, slide);
      }
      ContactCandidate c;
      c.gap = n_A.dot(x_A) + offset;
      if (c.gap > margin || fit_to_normal_cone(model_.tree, hit.sample, -n_A).isZero()) continue;
      if (!acts(X_UA_ * x_A)) continue;
      c.point_A = x_A - bodies_.p_MB[a_];
      c.normal_A = n_A;
      c.area = facing_area(model_, hit.sample, -n_A);
      c.share_A = c.point_A;
      c.feature = surface_feature(index, hit.sample);
      if (motion.may_close(c)) scratch.candidates.push_back(c);
    }
  }

  const BodyState& bodies_;
  BodyIndex a_, b_;
  const voxel::SurfaceModel& model_;
  Pose X_UA_;  // a's mesh frame in the frame of the faces
  Mat3 R_UA_;
  const CurvedSamples* curved_;  // of a, or null
};

}  // namespace

void append_face_contacts(const BodyState& bodies, const BodyPair& pair, Shapes shapes,
                          ExactSurfaces exact, double margin, const PairMotion& motion,
                          SurfaceScratch& scratch) {
  const ExactSurface* surface = exact.empty() ? nullptr : exact[bodies.shape[pair.body_a]].get();
  const SamplesAboveFaces faces(bodies, pair, shapes,
                                surface == nullptr ? nullptr : &surface->curved);
  if (bodies.geometry[pair.body_b] == model::Geometry::plane) {
    faces.append_plane(margin, motion, scratch);
  } else {
    faces.append_container(margin, motion, scratch);
  }
}

}  // namespace gotai::collision
