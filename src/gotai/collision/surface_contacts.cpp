#include "gotai/collision/surface_contacts.h"

#include <cmath>

#include "gotai/collision/relative_pose.h"

namespace gotai::collision {
namespace {

using model::BodyIndex;
using model::BodyState;
using Shapes = std::span<const std::shared_ptr<const voxel::Shape>>;

Vec3 to_double(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

Vec3 sample_point(const voxel::SurfaceModel& model, std::uint32_t sample) {
  const voxel::PointPacket& packet = model.tree.points[sample / voxel::kLanes];
  const std::uint32_t lane = sample % voxel::kLanes;
  return model.center + Vec3(packet.x[lane], packet.y[lane], packet.z[lane]);
}

SamplePose sample_pose(const Pose& X_BA, const voxel::SurfaceModel& a,
                       const voxel::SurfaceModel& b) {
  const Mat3 R = X_BA.q.toRotationMatrix();
  const Vec3 t = X_BA * a.center - b.center;
  SamplePose pose;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      pose.rotation[static_cast<std::size_t>(3 * i + j)] = static_cast<float>(R(i, j));
    }
    pose.translation[static_cast<std::size_t>(i)] = static_cast<float>(t[i]);
  }
  return pose;
}

// Largest float that is not above the margin, so that searches keep the promise of the margin.
float search_margin(double margin) {
  const auto rounded = static_cast<float>(margin);
  return static_cast<double>(rounded) > margin ? std::nextafter(rounded, 0.0F) : rounded;
}

// Samples of one body, P, in the field of the other, Q.
class FieldContacts {
 public:
  FieldContacts(const BodyState& bodies, const BodyPair& pair, Shapes shapes, bool samples_of_b)
      : samples_of_b_(samples_of_b),
        p_(samples_of_b ? pair.body_b : pair.body_a),
        q_(samples_of_b ? pair.body_a : pair.body_b),
        bodies_(bodies),
        samples_(shapes[bodies.shape[p_]]->surface),
        field_(shapes[bodies.shape[q_]]->surface),
        X_WP_(bodies.mesh_pose(p_)),
        X_QP_(relative_pose(bodies.mesh_pose(q_), X_WP_)),
        R_WP_(X_WP_.q.toRotationMatrix()),
        R_QP_(X_QP_.q.toRotationMatrix()) {}

  void append(double margin, SurfaceSearch& search, model::ContactSet& out) const {
    search_field(samples_.tree, field_.field, sample_pose(X_QP_, samples_, field_),
                 search_margin(margin), search);
    for (const SurfaceHit& hit : search.hits) append(hit, out);
  }

 private:
  void append(const SurfaceHit& hit, model::ContactSet& out) const {
    const Vec3 gradient_P = R_QP_.transpose() * to_double(hit.gradient);
    const double length = gradient_P.norm();
    // Where the field has no slope (the middle of a body) the sample's own normal is all there is.
    const Vec3 toward = length > 1e-3 ? Vec3(-gradient_P / length)
                                      : to_double(samples_.tree.normal[hit.sample]).normalized();
    const Vec3 d_P = fit_to_normal_cone(samples_.tree, hit.sample, toward);
    if (d_P.isZero()) return;
    const double gap = hit.distance;
    const Vec3 own_P = sample_point(samples_, hit.sample);
    const Vec3 other_P = own_P + gap * d_P;  // on Q's surface
    const Vec3 own = own_P - bodies_.p_MB[p_];
    const Vec3 other = X_QP_ * other_P - bodies_.p_MB[q_];
    const Vec3 normal = R_WP_ * (samples_of_b_ ? d_P : Vec3(-d_P));
    out.push(X_WP_.p + R_WP_ * (own_P + (0.5 * gap) * d_P), normal, gap,
             samples_of_b_ ? other : own, samples_of_b_ ? own : other,
             static_cast<double>(samples_.tree.area[hit.sample]),
             surface_feature(samples_of_b_ ? 1 : 0, hit.sample));
  }

  bool samples_of_b_;
  BodyIndex p_, q_;
  const BodyState& bodies_;
  const voxel::SurfaceModel& samples_;
  const voxel::SurfaceModel& field_;
  Pose X_WP_;  // P's mesh frame in the world
  Pose X_QP_;  // P's mesh frame in Q's
  Mat3 R_WP_, R_QP_;
};

// A half space that bodies rest on, in the frame of its body U: height is normal . p_U + offset.
struct Face {
  Vec3 normal;
  double offset;
};

// Samples of body a above the faces of body b.
class FaceContacts {
 public:
  FaceContacts(const BodyState& bodies, const BodyPair& pair, Shapes shapes)
      : bodies_(bodies),
        a_(pair.body_a),
        b_(pair.body_b),
        model_(shapes[bodies.shape[pair.body_a]]->surface),
        X_WA_(bodies.mesh_pose(pair.body_a)),
        X_UA_(relative_pose({bodies.x_W[pair.body_b], bodies.q_WB[pair.body_b]}, X_WA_)),
        R_UA_(X_UA_.q.toRotationMatrix()),
        R_WA_(X_WA_.q.toRotationMatrix()) {}

  // @param acts  (point in U): does the face act on it?
  template <typename Acts>
  void append(const Face& face, std::uint32_t index, double margin, SurfaceSearch& search,
              model::ContactSet& out, const Acts& acts) const {
    const Vec3 n_A = R_UA_.transpose() * face.normal;
    const double offset = face.normal.dot(X_UA_.p) + face.offset;
    const Eigen::Vector3f n = n_A.cast<float>();
    // Heights are searched in single precision with room to spare, then computed in double.
    const double slack = 1e-5 * (model_.edge + std::abs(offset));
    search_half_space(model_.tree, {n.x(), n.y(), n.z()},
                      static_cast<float>(offset + n_A.dot(model_.center)),
                      static_cast<float>(margin + slack), search);
    for (const SurfaceHit& hit : search.hits) {
      const Vec3 x_A = sample_point(model_, hit.sample);
      const double gap = n_A.dot(x_A) + offset;
      if (gap > margin || fit_to_normal_cone(model_.tree, hit.sample, -n_A).isZero()) continue;
      const Vec3 x_U = X_UA_ * x_A;
      if (!acts(x_U)) continue;
      out.push(X_WA_.p + R_WA_ * (x_A - (0.5 * gap) * n_A), R_WA_ * n_A, gap,
               x_A - bodies_.p_MB[a_], x_U - gap * face.normal,
               static_cast<double>(model_.tree.area[hit.sample]),
               surface_feature(index, hit.sample));
    }
  }

  // Faces of the open-top box: they act below its rim, and only on bodies whose centre is inside or
  // points that are.
  void append_container(double margin, SurfaceSearch& search, model::ContactSet& out) const {
    const Vec3 half = bodies_.half_extent[b_];
    const auto above_floor_area = [&half](const Vec3& p_U) {
      return std::abs(p_U.x()) <= half.x() && std::abs(p_U.y()) <= half.y();
    };
    const bool body_inside =
        above_floor_area(bodies_.q_WB[b_].conjugate() * (bodies_.x_W[a_] - bodies_.x_W[b_]));
    const auto acts = [&](const Vec3& p_U) { return body_inside || above_floor_area(p_U); };
    append({Vec3::UnitZ(), 0.0}, 0, margin, search, out, acts);
    const std::array<Face, 4> walls{{{Vec3::UnitX(), half.x()},
                                     {-Vec3::UnitX(), half.x()},
                                     {Vec3::UnitY(), half.y()},
                                     {-Vec3::UnitY(), half.y()}}};
    for (std::uint32_t w = 0; w < walls.size(); ++w) {
      append(walls[w], w + 1, margin, search, out,
             [&](const Vec3& p_U) { return p_U.z() <= half.z() && acts(p_U); });
    }
  }

 private:
  const BodyState& bodies_;
  BodyIndex a_, b_;
  const voxel::SurfaceModel& model_;
  Pose X_WA_;  // a's mesh frame in the world
  Pose X_UA_;  // a's mesh frame in the frame of the faces
  Mat3 R_UA_, R_WA_;
};

}  // namespace

Vec3 fit_to_normal_cone(const voxel::SurfaceTree& tree, std::uint32_t sample, const Vec3& toward) {
  const Vec3 axis = to_double(tree.normal[sample]).normalized();
  const double cosine = static_cast<double>(tree.cone_cosine[sample]);
  const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
  Vec3 d = toward;
  if (tree.edge[sample] >= 0) {
    // Normals of an edge are perpendicular to it.
    const auto edge = static_cast<std::size_t>(tree.edge[sample]);
    const Vec3 along = to_double(tree.edge_direction[edge]).normalized();
    d -= d.dot(along) * along;
    const double length = d.norm();
    if (length < 1e-6) return Vec3::Zero();
    d /= length;
  }
  const double along_axis = d.dot(axis);
  if (along_axis >= cosine) return d;
  if (along_axis <= -sine) return Vec3::Zero();  // more than 90 degrees from every normal
  const Vec3 across = d - along_axis * axis;
  return cosine * axis + (sine / across.norm()) * across;
}

void append_surface_contacts(const BodyState& bodies, const BodyPair& pair, Shapes shapes,
                             double margin, SurfaceSearch& scratch, model::ContactSet& out) {
  const auto begin = static_cast<std::uint32_t>(out.size());
  out.pairs.push_back({pair.body_a, pair.body_b, begin, begin});
  if (bodies.geometry[pair.body_b] == model::Geometry::shape) {
    FieldContacts(bodies, pair, shapes, false).append(margin, scratch, out);
    FieldContacts(bodies, pair, shapes, true).append(margin, scratch, out);
  } else {
    const FaceContacts faces(bodies, pair, shapes);
    if (bodies.geometry[pair.body_b] == model::Geometry::plane) {
      faces.append({Vec3::UnitZ(), 0.0}, 0, margin, scratch, out, [](const Vec3&) { return true; });
    } else {
      faces.append_container(margin, scratch, out);
    }
  }
  if (out.size() == begin) out.pairs.pop_back();
}

}  // namespace gotai::collision
