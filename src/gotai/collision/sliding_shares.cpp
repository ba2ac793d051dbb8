#include "gotai/collision/sliding_shares.h"

#include <algorithm>
#include <cmath>

namespace gotai::collision {
namespace {

// Sums over the parts of a share, all with directions of slip of length 1.
struct Resultant {
  Vec3 force = Vec3::Zero();  // along the slip [m^2]
  double moment = 0.0;        // about the share's centre and the patch's normal [m^3]
};

// How much candidates weigh that are samples of one body or the other, by direction 0 or 1.
std::array<double, 2> weigh_directions(std::span<const ContactCandidate> candidates) {
  std::array<double, 2> count{};
  for (const ContactCandidate& c : candidates) count[c.feature >> 32U == 1 ? 1 : 0] += 1.0;
  const double most = std::max(count[0], count[1]);
  for (double& n : count) n *= n / (most * most);
  return count;
}

// Areas and centres.
template <typename Weight>
void measure_shares(std::span<const ContactCandidate> candidates, const WrenchLanes& lanes,
                    const Weight& weight, std::size_t count, SharesFriction& shares) {
  std::fill_n(shares.begin(), count, ShareFriction{});
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    ShareFriction& share = shares[lanes.nearest[i]];
    share.area += weight(i);
    share.centre_A += weight(i) * candidates[i].point_A;
  }
  for (std::size_t k = 0; k < count; ++k) shares[k].centre_A /= shares[k].area;
}

// What opposes the slip of all parts of the shares.
template <typename Weight>
std::array<Resultant, kMaxReduced> sum_up_friction(std::span<const ContactCandidate> candidates,
                                                   const WrenchLanes& lanes, const Weight& weight,
                                                   const Vec3& normal, const SlipField& slip,
                                                   const SharesFriction& shares) {
  std::array<Resultant, kMaxReduced> sums;
  // Several at a time: roots and quotients take long.
  constexpr std::size_t kTogether = 8;
  using Doubles = Eigen::Array<double, kTogether, 1>;
  std::array<Vec3, kTogether> slipping;
  Doubles squared_speed = Doubles::Ones();
  Doubles weights = Doubles::Ones();
  for (std::size_t first = 0; first < candidates.size(); first += kTogether) {
    const std::size_t n = std::min(kTogether, candidates.size() - first);
    for (std::size_t l = 0; l < n; ++l) {
      const Vec3 v = slip.at(candidates[first + l].point_A);
      slipping[l] = v - normal.dot(v) * normal;
      squared_speed[static_cast<Eigen::Index>(l)] = slipping[l].squaredNorm();
      weights[static_cast<Eigen::Index>(l)] = weight(first + l);
    }
    const Doubles scale = weights / squared_speed.sqrt();
    for (std::size_t l = 0; l < n; ++l) {
      if (!(squared_speed[static_cast<Eigen::Index>(l)] > 0.0)) continue;
      const Vec3 force = scale[static_cast<Eigen::Index>(l)] * slipping[l];
      const std::size_t k = lanes.nearest[first + l];
      const Vec3 arm = candidates[first + l].point_A - shares[k].centre_A;
      sums[k].force += force;
      sums[k].moment += normal.dot(arm.cross(force));
    }
  }
  return sums;
}

}  // namespace

bool find_sliding_shares(std::span<const ContactCandidate> candidates, const WrenchLanes& lanes,
                         const Vec3& normal, double reach, const SlipField& slip, std::size_t count,
                         SharesFriction& shares) {
  const std::array<double, 2> of_direction = weigh_directions(candidates);
  const auto weight = [&](std::size_t i) {
    const ContactCandidate& c = candidates[i];
    return c.area * static_cast<double>(lanes.weight[i]) *
           of_direction[c.feature >> 32U == 1 ? 1 : 0];
  };
  measure_shares(candidates, lanes, weight, count, shares);
  const std::array<Resultant, kMaxReduced> sums =
      sum_up_friction(candidates, lanes, weight, normal, slip, shares);

  const double spin = normal.dot(slip.w_A);
  const auto within_reach = [reach](double x) { return std::clamp(x, -reach, reach); };
  double force = 0.0;
  double missing = 0.0;
  std::array<Vec3, kMaxReduced> across;
  for (std::size_t k = 0; k < count; ++k) {
    const double length = sums[k].force.norm();
    ShareFriction& share = shares[k];
    share.point_A = share.centre_A;
    share.alignment = std::min(1.0, length / share.area);
    across[k].setZero();
    missing += sums[k].moment;
    if (!(length > 0.0)) continue;
    const Vec3 along = sums[k].force / length;
    across[k] = along.cross(normal);
    const double lever = within_reach(sums[k].moment / length);
    // On the line where the slip has no part across the force.
    const double aside = across[k].dot(slip.at(share.centre_A));
    const bool turns = std::abs(spin) * reach > 1e-6 * std::abs(aside);
    const double shift = turns ? within_reach(aside / spin) : 0.0;
    share.point_A += lever * across[k] + shift * along;
    missing -= lever * length;
    force += length;
  }
  if (!(force > 0.0)) return false;
  const double rest = within_reach(missing / force);
  for (std::size_t k = 0; k < count; ++k) shares[k].point_A += rest * across[k];
  return true;
}

}  // namespace gotai::collision
