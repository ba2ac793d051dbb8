/// @file
/// How far the two bodies of a pair may come towards each other within a step.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "gotai/collision/broad_phase.h"
#include "gotai/collision/reduction.h"
#include "gotai/model/body_state.h"

namespace gotai::collision {

/// Which contacts may close within a step, in single precision: those whose gap is at most
/// gap + time * (speed of approach along the normal). Frame A.
struct Closing {
  std::array<float, 3> velocity;  ///< of body a against b at a's centre of mass [m/s]
  std::array<float, 3> turn;      ///< of body a against b [rad/s]
  float gap;                      ///< [m]
  float time;                     ///< [s]
};

/// How two bodies move against each other within a step, in the frame of body a (its axes, its
/// centre of mass), and which contacts matter then. Lengths in metres.
class PairMotion {
 public:
  /// @param dt  [s]; 0: not in a step, everything within a margin matters
  PairMotion(const model::BodyState& bodies, const BodyPair& pair, double dt) : dt_(dt) {
    const model::BodyIndex a = pair.body_a;
    const model::BodyIndex b = pair.body_b;
    size_ = 2.0 * bodies.bounding_radius[a];
    between_shapes_ = bodies.geometry[b] == model::Geometry::shape;
    if (between_shapes_) size_ = std::min(size_, 2.0 * bodies.bounding_radius[b]);
    q_WA_ = bodies.q_WB[a];
    const Vec3 from_b = bodies.x_W[a] - bodies.x_W[b];
    v_W_ = bodies.v_W[a] - bodies.v_W[b] - bodies.w_W[b].cross(from_b);
    w_W_ = bodies.w_W[a] - bodies.w_W[b];
    const double turning = w_W_.norm();
    fastest_ = v_W_.norm() + turning * bodies.bounding_radius[a];
    fastest_near_b_ = fastest_;
    // The search of what hardly moves has nothing to gain.
    if (between_shapes_ && farthest() > rest_reach()) {
      limit_to_lens(-from_b, turning, bodies.bounding_radius[a], bodies.bounding_radius[b]);
    }
  }

  /// Is this about a step?
  bool in_step() const { return dt_ > 0.0; }
  /// How a moves along b.
  SlipField slip() const { return {v_A(), w_A()}; }
  /// Diameter about the smaller body.
  double size() const { return size_; }
  /// Gap up to which contacts at rest may carry.
  double rest_reach() const { return kRestReach * size_; }
  /// No point of a moves farther against b in the step.
  double farthest() const { return fastest_ * dt_; }

  /// The margin up to which contacts of this pair matter in the step.
  double reach(double margin) const {
    if (!in_step()) return margin;
    const double needed = rest_reach() + fastest_near_b_ * dt_;
    return std::min({margin, needed, between_shapes_ ? kFarthestReach * size_ : needed});
  }

  /// Can this contact close within the step?
  bool may_close(const ContactCandidate& c) const {
    if (!in_step()) return true;
    const double approach = std::max(0.0, -c.normal_A.dot(v_A() + w_A().cross(c.point_A)));
    return c.gap <= (kRestReach + kImpactReach) * size_ + kApproachSafety * approach * dt_;
  }
  /// The same for many contacts at a time.
  Closing closing() const {
    const Eigen::Vector3f v = v_A().cast<float>();
    const Eigen::Vector3f w = w_A().cast<float>();
    const double gap =
        in_step() ? (kRestReach + kImpactReach) * size_ : std::numeric_limits<double>::infinity();
    return {{v.x(), v.y(), v.z()},
            {w.x(), w.y(), w.z()},
            static_cast<float>(gap),
            static_cast<float>(kApproachSafety * dt_)};
  }

 private:
  // What closes within the step is near b's sphere and in a's own: how fast is the lens between
  // them, at most, by the ball around it?
  void limit_to_lens(const Vec3& to_b, double turning, double radius_a, double radius_b) {
    const double near_b = radius_b + std::min(rest_reach() + farthest(), kFarthestReach * size_);
    const double distance = to_b.norm();
    // From a's centre to the plane through the spheres' common circle.
    const double to_plane =
        0.5 * (distance * distance + radius_a * radius_a - near_b * near_b) / distance;
    if (!(to_plane > 0.0 && to_plane < distance)) return;
    const double width = std::sqrt(std::max(0.0, radius_a * radius_a - to_plane * to_plane));
    const Vec3 middle = (to_plane / distance) * to_b;
    fastest_near_b_ = std::min(fastest_, (v_W_ + w_W_.cross(middle)).norm() + turning * width);
  }

  Vec3 v_A() const { return q_WA_.conjugate() * v_W_; }
  Vec3 w_A() const { return q_WA_.conjugate() * w_W_; }

  // Reaches, as fractions of size(): of contacts at rest; of what impacts elsewhere may add to the
  // approach within a step; and the farthest between shapes.
  static constexpr double kRestReach = 0.003;
  static constexpr double kImpactReach = 0.025;
  static constexpr double kFarthestReach = 0.4;
  static constexpr double kApproachSafety = 1.3;

  double dt_;
  double size_;
  bool between_shapes_;
  Quat q_WA_;
  Vec3 v_W_, w_W_;         // of a against b, at a's centre of mass; W
  double fastest_;         // no point of a moves faster against b [m/s]
  double fastest_near_b_;  // of those that can meet b in the step
};

}  // namespace gotai::collision
