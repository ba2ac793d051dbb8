#include "gotai/impulse/sliding.h"

#include <algorithm>

#include "gotai/impulse/contact_kinematics.h"

namespace gotai::impulse {

bool is_sliding(const model::BodyState& bodies, const model::ContactSet& contacts,
                const model::ContactPair& pair, double stopping_speed) {
  const RelativeMotion motion(bodies, pair);
  // Contacts are on the surface of a, or up to half their gap beside it.
  constexpr double kAround = 1.5;
  const double arm = kAround * bodies.bounding_radius[pair.body_a];
  if (motion.v_W.norm() + arm * motion.w_W.norm() <= stopping_speed) return false;
  for (std::uint32_t c = pair.begin; c < pair.end; ++c) {
    const Vec3& n = contacts.normal_W[c];
    const Vec3 v = motion.v_W + motion.w_W.cross(contacts.friction_W[c] - motion.origin_W);
    if ((v - n.dot(v) * n).squaredNorm() > stopping_speed * stopping_speed) return true;
  }
  return false;
}

std::span<const model::SlidingShare> sliding_shares(const model::ContactSet& contacts,
                                                    const model::ContactPair& pair) {
  const auto begin =
      std::ranges::lower_bound(contacts.sliding, pair.begin, {}, &model::SlidingShare::contact);
  const auto end = std::ranges::lower_bound(begin, contacts.sliding.end(), pair.end, {},
                                            &model::SlidingShare::contact);
  return {begin, end};
}

}  // namespace gotai::impulse
