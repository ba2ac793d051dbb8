#include "gotai/collision/anchored_contacts.h"

#include "gotai/collision/relative_pose.h"

namespace gotai::collision {

bool is_near_anchor(const model::ContactAnchors::Pair& anchor, const model::BodyState& bodies,
                    const PairMotion& motion, double reach) {
  const double moved = displacement(anchor.X_BA, body_pose(bodies, {anchor.body_a, anchor.body_b}),
                                    bodies.bounding_radius[anchor.body_a]);
  return moved + motion.farthest() <= kAnchorTolerance * motion.size() &&
         reach + moved <= anchor.reach;
}

void write_anchored(const model::ContactAnchors::Pair& anchor, const model::BodyState& bodies,
                    std::size_t begin, model::ContactSet& out) {
  const Vec3& x_A = bodies.x_W[anchor.body_a];
  const Vec3 from_b_to_a = x_A - bodies.x_W[anchor.body_b];
  const Mat3 R_WA = bodies.q_WB[anchor.body_a].toRotationMatrix();
  const Mat3 R_WB = bodies.q_WB[anchor.body_b].toRotationMatrix();
  for (std::size_t i = begin; i < begin + anchor.contacts.size(); ++i) {
    const model::ContactAnchors::Contact& c = anchor.contacts[i - begin];
    // Both about the centre of body a: far from the world's origin the other order would cancel.
    const Vec3 on_a = R_WA * c.point_A;
    const Vec3 on_b = R_WB * c.point_B - from_b_to_a;
    const Vec3 normal = R_WB * c.normal_B;
    out.point_W[i] = x_A + 0.5 * (on_a + on_b);
    out.normal_W[i] = normal;
    out.gap[i] = normal.dot(on_a - on_b);
    out.anchor_A[i] = c.point_A;
    out.anchor_B[i] = c.point_B;
    out.friction_W[i] = x_A + R_WA * c.friction_A;
    out.area[i] = c.area;
    out.feature[i] = c.feature;
  }
}

}  // namespace gotai::collision
