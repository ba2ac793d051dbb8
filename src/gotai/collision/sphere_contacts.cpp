#include "gotai/collision/sphere_contacts.h"

#include <cmath>

#include "gotai/collision/face.h"
#include "gotai/collision/relative_pose.h"

namespace gotai::collision {

namespace {

using model::BodyIndex;
using model::BodyState;

/// Normal for spheres whose centres coincide, W.
Vec3 fallback_normal(const BodyState& bodies, const BodyPair& pair) {
  const Vec3 between = bodies.x_W[pair.body_a] - bodies.x_W[pair.body_b];
  const double distance = between.norm();
  return distance > 1e-12 * bodies.bounding_radius[pair.body_a] && distance > 0.0
             ? Vec3(between / distance)
             : Vec3::UnitZ();
}

void append_shape_contacts(const BodyState& bodies, const BodyPair& pair,
                           std::span<const SphereTree> trees, int level, double margin,
                           SphereScratch& scratch, model::ContactSet& out, TestCounts& tests) {
  const BodyIndex a = pair.body_a;
  const BodyIndex b = pair.body_b;
  const SphereTree& tree_a = trees[bodies.shape[a]];
  const SphereTree& tree_b = trees[bodies.shape[b]];
  const Pose X_WB = bodies.mesh_pose(b);
  const Pose X_BA = relative_pose(X_WB, bodies.mesh_pose(a));
  descend(tree_a, tree_b, X_BA, level, margin, scratch.descent, scratch.overlaps, tests);
  if (scratch.overlaps.empty()) return;

  const double r_A = tree_a.pyramid->grid.voxel_radius(level);
  const double r_B = tree_b.pyramid->grid.voxel_radius(level);
  const Mat3 R_WB = X_WB.q.toRotationMatrix();
  const Mat3 R_AB = X_BA.q.toRotationMatrix().transpose();
  const std::vector<Vec3>& centers_a = tree_a.centers_of(level);
  const std::vector<Vec3>& centers_b = tree_b.centers_of(level);
  auto i = out.size();
  out.resize(i + scratch.overlaps.size());
  out.pairs.push_back(
      {a, b, static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(out.size())});
  for (const SphereOverlap& overlap : scratch.overlaps) {
    const Vec3& c_B = centers_b[overlap.b];
    const Vec3 between = overlap.c_A - c_B;
    const bool coincident = overlap.distance <= 1e-12 * (r_A + r_B);
    const Vec3 n_B = coincident ? Vec3(R_WB.transpose() * fallback_normal(bodies, pair))
                                : Vec3(between / overlap.distance);
    out.point_W[i] = X_WB.p + R_WB * (c_B + (r_B / (r_A + r_B)) * between);
    out.friction_W[i] = out.point_W[i];
    out.normal_W[i] = R_WB * n_B;
    // Without coincidence between . n is the distance; with it, the little that is left.
    out.gap[i] = (coincident ? between.dot(n_B) : overlap.distance) - (r_A + r_B);
    out.anchor_A[i] = centers_a[overlap.a] - r_A * (R_AB * n_B) - bodies.p_MB[a];
    out.anchor_B[i] = c_B + r_B * n_B - bodies.p_MB[b];
    out.area[i] = 1.0;
    out.feature[i] = static_cast<model::FeatureKey>(overlap.a) << 32U | overlap.b;
    ++i;
  }
}

/// Descends one pyramid to level k; keeps the voxels for which reaches(center, r, h) holds.
template <typename Reaches>
void descend_one(const SphereTree& tree, int level, SphereScratch& scratch, TestCounts& tests,
                 const Reaches& reaches) {
  std::vector<std::uint32_t>& current = scratch.voxels;
  std::vector<std::uint32_t>& next = scratch.next_voxels;
  const auto keep = [&](int h, std::uint32_t voxel) {
    // Children touch their parent's sphere from inside: rounding must not lose them (erratum 13).
    const double r = tree.pyramid->grid.voxel_radius(h) * (h < level ? 1.0 + 1e-12 : 1.0);
    return reaches(tree.centers_of(h)[voxel], r);
  };
  current.clear();
  ++tests[0];
  if (keep(1, 0)) current.push_back(0);
  for (int h = 2; h <= level && !current.empty(); ++h) {
    const std::vector<std::uint32_t>& first_child = tree.pyramid->level(h - 1).first_child;
    next.clear();
    for (const std::uint32_t parent : current) {
      tests[static_cast<std::size_t>(h) - 1] += first_child[parent + 1] - first_child[parent];
      for (std::uint32_t c = first_child[parent]; c < first_child[parent + 1]; ++c) {
        if (keep(h, c)) next.push_back(c);
      }
    }
    std::swap(current, next);
  }
}

/// Shape a against a body with faces, u.
class SpheresAboveFaces {
 public:
  SpheresAboveFaces(const BodyState& bodies, const BodyPair& pair, const SphereTree& tree,
                    int level, double margin)
      : bodies_(bodies), pair_(pair), tree_(tree), level_(level), margin_(margin) {
    X_WA_ = bodies.mesh_pose(pair.body_a);
    X_UA_ = relative_pose({bodies.x_W[pair.body_b], bodies.q_WB[pair.body_b]}, X_WA_);
    R_UA_ = X_UA_.q.toRotationMatrix();
  }

  /// Centre of a voxel in U.
  Vec3 center_U(const Vec3& center_A) const { return R_UA_ * center_A + X_UA_.p; }

  /// Appends the contacts with one face.
  /// @param touches  (center in A, r): can a sphere of a coarser or the finest level touch besides
  ///                 its height above the face?
  /// @param acts     (center in A): does the face act on a sphere of the finest level?
  template <typename Touches, typename Acts>
  void append(const Face& face, std::uint32_t face_index, SphereScratch& scratch,
              model::ContactSet& out, TestCounts& tests, const Touches& touches,
              const Acts& acts) const {
    const Vec3 n_A = R_UA_.transpose() * face.normal;
    const double offset = face.normal.dot(X_UA_.p) + face.offset;
    descend_one(tree_, level_, scratch, tests, [&](const Vec3& center, double r) {
      return n_A.dot(center) + offset - r <= margin_ && touches(center, r);
    });

    const double r = tree_.pyramid->grid.voxel_radius(level_);
    const std::vector<Vec3>& centers = tree_.centers_of(level_);
    const Mat3 R_WA = X_WA_.q.toRotationMatrix();
    const Vec3 n_W = bodies_.q_WB[pair_.body_b] * face.normal;
    const Vec3& p_MA = bodies_.p_MB[pair_.body_a];
    for (const std::uint32_t voxel : scratch.voxels) {
      const Vec3& center = centers[voxel];
      if (!acts(center)) continue;
      const double height = n_A.dot(center) + offset;
      const Vec3 lowest = center - r * n_A;
      out.push(X_WA_.p + R_WA * lowest, n_W, height - r, lowest - p_MA,
               center_U(center) - height * face.normal, 1.0,
               static_cast<model::FeatureKey>(face_index) << 32U | voxel);
    }
  }

 private:
  const BodyState& bodies_;
  const BodyPair& pair_;
  const SphereTree& tree_;
  int level_;
  double margin_;
  Pose X_WA_;  // a's mesh frame in the world
  Pose X_UA_;  // a's mesh frame in the frame of the faces
  Mat3 R_UA_;
};

void append_plane_contacts(const SpheresAboveFaces& contacts, SphereScratch& scratch,
                           model::ContactSet& out, TestCounts& tests) {
  contacts.append(
      floor_face(), 0, scratch, out, tests, [](const Vec3&, double) { return true; },
      [](const Vec3&) { return true; });
}

void append_container_contacts(const BodyState& bodies, const BodyPair& pair,
                               const SpheresAboveFaces& contacts, SphereScratch& scratch,
                               model::ContactSet& out, TestCounts& tests) {
  const Vec3 half = bodies.half_extent[pair.body_b];
  const auto above_floor_area = [&half](const Vec3& p_U) {
    return std::abs(p_U.x()) <= half.x() && std::abs(p_U.y()) <= half.y();
  };
  const bool body_inside = above_floor_area(bodies.q_WB[pair.body_b].conjugate() *
                                            (bodies.x_W[pair.body_a] - bodies.x_W[pair.body_b]));
  const auto acts = [&](const Vec3& center) {
    return body_inside || above_floor_area(contacts.center_U(center));
  };
  contacts.append(
      floor_face(), 0, scratch, out, tests, [](const Vec3&, double) { return true; }, acts);
  const std::array<Face, 4> walls = container_walls(half);
  for (std::uint32_t w = 0; w < walls.size(); ++w) {
    contacts.append(
        walls[w], w + 1, scratch, out, tests,
        [&](const Vec3& center, double r) { return contacts.center_U(center).z() - r <= half.z(); },
        [&](const Vec3& center) {
          return contacts.center_U(center).z() <= half.z() && acts(center);
        });
  }
}

}  // namespace

void append_sphere_contacts(const BodyState& bodies, const BodyPair& pair,
                            std::span<const SphereTree> trees, int level, double margin,
                            SphereScratch& scratch, model::ContactSet& out, TestCounts& tests) {
  if (bodies.geometry[pair.body_b] == model::Geometry::shape) {
    append_shape_contacts(bodies, pair, trees, level, margin, scratch, out, tests);
    return;
  }
  const auto begin = static_cast<std::uint32_t>(out.size());
  out.pairs.push_back({pair.body_a, pair.body_b, begin, begin});
  const SpheresAboveFaces contacts(bodies, pair, trees[bodies.shape[pair.body_a]], level, margin);
  if (bodies.geometry[pair.body_b] == model::Geometry::plane) {
    append_plane_contacts(contacts, scratch, out, tests);
  } else {
    append_container_contacts(bodies, pair, contacts, scratch, out, tests);
  }
  if (out.size() == begin) out.pairs.pop_back();
}

}  // namespace gotai::collision
