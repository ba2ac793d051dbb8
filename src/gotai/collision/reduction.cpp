#include "gotai/collision/reduction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace gotai::collision {
namespace {

double squared_distance(const ContactCandidate& x, const ContactCandidate& y, double inverse) {
  const Vec3 moment = x.point_A.cross(x.normal_A) - y.point_A.cross(y.normal_A);
  return (x.normal_A - y.normal_A).squaredNorm() + moment.squaredNorm() * (inverse * inverse);
}

class Chooser {
 public:
  Chooser(std::span<ContactCandidate> candidates, const ReductionScale& scale, Reduction& reduction)
      : candidates_(candidates), scale_(scale), reduction_(reduction) {
    reduction_.kept.clear();
    reduction_.distance.assign(candidates.size(), std::numeric_limits<double>::infinity());
    reduction_.likeness.assign(candidates.size(), std::numeric_limits<double>::infinity());
    reduction_.nearest.assign(candidates.size(), 0);
    for (std::uint32_t i = 1; i < candidates.size(); ++i) {
      if (candidates[i].gap < candidates[deepest_].gap) deepest_ = i;
    }
  }

  void keep(std::uint32_t chosen) {
    const auto position = static_cast<std::uint32_t>(reduction_.kept.size());
    reduction_.kept.push_back(chosen);
    for (std::uint32_t i = 0; i < candidates_.size(); ++i) {
      const double d = squared_distance(candidates_[i], candidates_[chosen], 1.0 / scale_.length);
      const double likeness = d + squared_reaches(candidates_[i].gap - candidates_[chosen].gap);
      reduction_.distance[i] = std::min(reduction_.distance[i], d);
      if (likeness < reduction_.likeness[i]) {
        reduction_.likeness[i] = likeness;
        reduction_.nearest[i] = position;
      }
    }
    reduction_.distance[chosen] = -1.0;
    reduction_.likeness[chosen] = -1.0;
    reduction_.nearest[chosen] = position;
  }

  bool is_kept(std::uint32_t i) const { return reduction_.distance[i] < 0.0; }

  void keep_remembered(std::span<const model::ContactMemory::Entry> remembered) {
    struct Carrier {
      std::uint32_t candidate;
      double squared_impulse;
    };
    std::array<Carrier, kMaxRemembered> carriers;
    std::size_t count = 0;
    std::size_t m = 0;
    for (std::uint32_t i = 0; i < candidates_.size(); ++i) {
      while (m < remembered.size() && remembered[m].feature < candidates_[i].feature) ++m;
      if (m == remembered.size()) break;
      if (remembered[m].feature != candidates_[i].feature) continue;
      const Carrier carrier{i, remembered[m].impulse_W.squaredNorm()};
      std::size_t at = count;
      while (at > 0 && carriers[at - 1].squared_impulse < carrier.squared_impulse) --at;
      if (at == kMaxRemembered) continue;
      count = std::min(count + 1, kMaxRemembered);
      for (std::size_t k = count - 1; k > at; --k) carriers[k] = carriers[k - 1];
      carriers[at] = carrier;
    }
    for (std::size_t k = 0; k < count; ++k) keep(carriers[k].candidate);
  }

  void keep_deepest() {
    double kept_gap = std::numeric_limits<double>::infinity();
    for (const std::uint32_t k : reduction_.kept) {
      kept_gap = std::min(kept_gap, candidates_[k].gap);
    }
    if (candidates_[deepest_].gap < kept_gap - scale_.depth_step && !is_kept(deepest_)) {
      keep(deepest_);
    }
  }

  void keep_farthest() {
    for (;;) {
      std::uint32_t farthest = 0;
      double most_wanted = -1.0;
      double largest = 0.0;
      for (std::uint32_t i = 0; i < candidates_.size(); ++i) {
        const double squared = reduction_.distance[i];
        largest = std::max(largest, squared);
        if (squared <= scale_.resolution * scale_.resolution) continue;
        const double wanted =
            squared / (1.0 + squared_reaches(candidates_[i].gap - candidates_[deepest_].gap));
        if (wanted > most_wanted) {
          most_wanted = wanted;
          farthest = i;
        }
      }
      reduction_.error = std::sqrt(largest);
      if (reduction_.kept.size() >= kMaxReduced || most_wanted < 0.0) return;
      keep(farthest);
    }
  }

  // Areas and their centres go to the nearest kept contacts.
  void share() {
    const double lever = lever_arm([](const ContactCandidate& c) { return c.point_A; });
    std::array<Vec3, kMaxReduced> centre;
    std::array<double, kMaxReduced> area{};
    centre.fill(Vec3::Zero());
    for (std::uint32_t i = 0; i < candidates_.size(); ++i) {
      const ContactCandidate& c = candidates_[i];
      centre[reduction_.nearest[i]] += c.area * c.point_A;
      area[reduction_.nearest[i]] += c.area;
    }
    for (ContactCandidate& c : candidates_) c.area = 0.0;
    for (std::size_t k = 0; k < reduction_.kept.size(); ++k) {
      ContactCandidate& c = candidates_[reduction_.kept[k]];
      c.share_A = centre[k] / area[k];
      c.area = area[k];
    }
    restore_lever(lever);
    std::sort(reduction_.kept.begin(), reduction_.kept.end());
  }

 private:
  double squared_reaches(double gap_difference) const {
    const double reaches = gap_difference / scale_.reach;
    return reaches * reaches;
  }

  // Mean distance of the area from its centre, which friction against spinning acts on under even
  // pressure [m].
  template <typename Place>
  double lever_arm(const Place& place) {
    double area = 0.0;
    centre_.setZero();
    for (const ContactCandidate& c : candidates_) {
      area += c.area;
      centre_ += c.area * place(c);
    }
    centre_ /= area;
    double sum = 0.0;
    for (const ContactCandidate& c : candidates_) sum += c.area * (place(c) - centre_).norm();
    return sum / area;
  }

  // The centres of shares are nearer to the middle than what they stand for. On a flat patch they
  // move out until friction has its lever arm back; on others that means nothing.
  void restore_lever(double lever) {
    constexpr double kFlat = 0.95;
    constexpr double kMostStretch = 1.5;
    Vec3 normal = Vec3::Zero();
    double area = 0.0;
    for (const ContactCandidate& c : candidates_) {
      normal += c.area * c.normal_A;
      area += c.area;
    }
    const double shares = lever_arm([](const ContactCandidate& c) { return c.share_A; });
    if (normal.norm() < kFlat * area || !(shares > 0.0)) return;
    const double stretch = std::clamp(lever / shares, 1.0, kMostStretch);
    for (const std::uint32_t k : reduction_.kept) {
      candidates_[k].share_A = centre_ + stretch * (candidates_[k].share_A - centre_);
    }
  }

  std::span<ContactCandidate> candidates_;
  const ReductionScale& scale_;
  Reduction& reduction_;
  std::uint32_t deepest_ = 0;
  Vec3 centre_ = Vec3::Zero();  // of the area that lever_arm() looked at last
};

}  // namespace

void reduce_contacts(std::span<ContactCandidate> candidates,
                     std::span<const model::ContactMemory::Entry> remembered,
                     const ReductionScale& scale, Reduction& reduction) {
  Chooser chooser(candidates, scale, reduction);
  reduction.error = 0.0;
  if (candidates.empty()) return;
  chooser.keep_remembered(remembered);
  chooser.keep_deepest();
  chooser.keep_farthest();
  chooser.share();
}

}  // namespace gotai::collision
