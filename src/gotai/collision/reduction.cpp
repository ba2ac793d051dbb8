#include "gotai/collision/reduction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "gotai/collision/lanes.h"

namespace gotai::collision {
namespace {

class Chooser {
 public:
  Chooser(std::span<ContactCandidate> candidates, const ReductionScale& scale, Reduction& reduction)
      : candidates_(candidates), scale_(scale), reduction_(reduction), lanes_(reduction.lanes) {
    const std::size_t n = candidates.size();
    const std::size_t padded = (n + kLanes - 1) / kLanes * kLanes;
    reduction_.kept.clear();
    make_room(padded);
    for (std::uint32_t i = 1; i < n; ++i) {
      if (candidates[i].gap < candidates[deepest_].gap) deepest_ = i;
    }
    const double per_length = 1.0 / scale.length;
    const double per_reach = 1.0 / scale.reach;
    for (std::size_t i = 0; i < n; ++i) {
      const ContactCandidate& c = candidates[i];
      const Vec3 moment = per_length * c.point_A.cross(c.normal_A);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        lanes_.wrench[axis][i] = static_cast<float>(c.normal_A[static_cast<int>(axis)]);
        lanes_.wrench[3 + axis][i] = static_cast<float>(moment[static_cast<int>(axis)]);
      }
      lanes_.reaches[i] = static_cast<float>((c.gap - candidates[deepest_].gap) * per_reach);
      lanes_.weight[i] = 1.0F / (1.0F + lanes_.reaches[i] * lanes_.reaches[i]);
    }
    // What fills the last packet up is kept already, so that it is never wanted.
    constexpr float kInfinite = std::numeric_limits<float>::infinity();
    std::fill(lanes_.distance.begin(), lanes_.distance.end(), kInfinite);
    std::fill(lanes_.likeness.begin(), lanes_.likeness.end(), kInfinite);
    for (std::size_t i = n; i < padded; ++i) {
      lanes_.distance[i] = -1.0F;
      lanes_.reaches[i] = 0.0F;
      lanes_.weight[i] = 0.0F;
      for (std::vector<float>& part : lanes_.wrench) part[i] = 0.0F;
    }
  }

  void keep(std::uint32_t chosen) {
    const auto position = static_cast<std::uint32_t>(reduction_.kept.size());
    reduction_.kept.push_back(chosen);
    const auto same = static_cast<float>(scale_.resolution * scale_.resolution);
    farthest_ = keep_wrench(lanes_, chosen, position, same);
  }

  bool is_kept(std::uint32_t i) const { return lanes_.distance[i] < 0.0F; }

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
    while (reduction_.kept.size() < kMaxReduced && farthest_.index != FarthestWrench::kNone) {
      keep(farthest_.index);
    }
    reduction_.error = std::sqrt(static_cast<double>(farthest_.squared));
  }

  // Areas and their centres go to the nearest kept contacts.
  void share(const SlipField* slip) {
    for (ContactCandidate& c : candidates_) c.share_A = c.point_A;
    std::array<Vec3, kMaxReduced> centre;
    std::array<double, kMaxReduced> area{};
    Vec3 normal = Vec3::Zero();
    double total = 0.0;
    centre.fill(Vec3::Zero());
    for (std::uint32_t i = 0; i < candidates_.size(); ++i) {
      const ContactCandidate& c = candidates_[i];
      centre[lanes_.nearest[i]] += c.area * c.point_A;
      area[lanes_.nearest[i]] += c.area;
      normal += c.area * c.normal_A;
      total += c.area;
    }
    // On other patches lever arms and directions of slip mean nothing.
    constexpr double kFlat = 0.95;
    const double lever = normal.norm() >= kFlat * total
                             ? lever_arm(candidates_.size(), [](std::size_t i) { return i; })
                             : 0.0;
    const bool flat = lever > 0.0;
    SharesFriction shares;
    // What does not touch yet has no friction.
    const bool slides = flat && slip != nullptr && candidates_[deepest_].gap <= scale_.reach &&
                        find_sliding_shares(candidates_, lanes_, normal.normalized(), lever, *slip,
                                            reduction_.kept.size(), shares);
    for (ContactCandidate& c : candidates_) c.area = 0.0;
    for (std::size_t k = 0; k < reduction_.kept.size(); ++k) {
      ContactCandidate& c = candidates_[reduction_.kept[k]];
      c.share_A = centre[k] / area[k];
      c.area = area[k];
    }
    if (flat) restore_lever(lever);
    sort_kept(shares, slides);
  }

 private:
  void make_room(std::size_t count) {
    for (std::vector<float>& part : lanes_.wrench) part.resize(count);
    for (std::vector<float>* values :
         {&lanes_.reaches, &lanes_.weight, &lanes_.distance, &lanes_.likeness}) {
      values->resize(count);
    }
    lanes_.nearest.resize(count);
  }

  // Mean distance of the area of some candidates from its centre, which friction against spinning
  // acts on under even pressure [m].
  // @param at  (k): index of the k-th of them
  template <typename At>
  double lever_arm(std::size_t count, const At& at) {
    double area = 0.0;
    centre_.setZero();
    for (std::size_t k = 0; k < count; ++k) {
      const ContactCandidate& c = candidates_[at(k)];
      area += c.area;
      centre_ += c.area * c.share_A;
    }
    centre_ /= area;
    double sum = 0.0;
    for (std::size_t k = 0; k < count; ++k) {
      const ContactCandidate& c = candidates_[at(k)];
      sum += c.area * (c.share_A - centre_).norm();
    }
    return sum / area;
  }

  // The centres of shares are nearer to the middle than what they stand for: they move out until
  // friction has its lever arm back.
  void restore_lever(double lever) {
    constexpr double kMostStretch = 1.5;
    const double shares =
        lever_arm(reduction_.kept.size(), [&](std::size_t k) { return reduction_.kept[k]; });
    if (!(shares > 0.0)) return;
    const double stretch = std::clamp(lever / shares, 1.0, kMostStretch);
    for (const std::uint32_t k : reduction_.kept) {
      candidates_[k].share_A = centre_ + stretch * (candidates_[k].share_A - centre_);
    }
  }

  // Ascending; until now they were in the order of their choice.
  void sort_kept(const SharesFriction& shares, bool slides) {
    std::array<std::uint32_t, kMaxReduced> chosen;
    std::copy(reduction_.kept.begin(), reduction_.kept.end(), chosen.begin());
    std::sort(reduction_.kept.begin(), reduction_.kept.end());
    if (!slides) return;
    for (const std::uint32_t k : reduction_.kept) {
      const auto at = std::find(chosen.begin(), chosen.end(), k) - chosen.begin();
      reduction_.sliding.push_back(shares[static_cast<std::size_t>(at)]);
    }
  }

  std::span<ContactCandidate> candidates_;
  const ReductionScale& scale_;
  Reduction& reduction_;
  WrenchLanes& lanes_;
  FarthestWrench farthest_;  // after what was kept last
  std::uint32_t deepest_ = 0;
  Vec3 centre_ = Vec3::Zero();  // of the area that lever_arm() looked at last
};

}  // namespace

void reduce_contacts(std::span<ContactCandidate> candidates,
                     std::span<const model::ContactMemory::Entry> remembered,
                     const ReductionScale& scale, Reduction& reduction, const SlipField* slip) {
  Chooser chooser(candidates, scale, reduction);
  reduction.error = 0.0;
  reduction.sliding.clear();
  if (candidates.empty()) return;
  chooser.keep_remembered(remembered);
  chooser.keep_deepest();
  chooser.keep_farthest();
  chooser.share(slip);
}

void drop_far_and_twins(std::span<ContactCandidate> candidates, double farthest, double length,
                        Reduction& reduction) {
  constexpr double kSamePoint = 1e-3;  // of the length
  constexpr double kSameNormal = 0.02;
  if (!reduction.sliding.empty()) return;
  const double same_point = kSamePoint * length;
  const auto are_twins = [&](const ContactCandidate& c, const ContactCandidate& d) {
    return (c.point_A - d.point_A).squaredNorm() < same_point * same_point &&
           (c.normal_A - d.normal_A).squaredNorm() < kSameNormal * kSameNormal;
  };
  std::vector<std::uint32_t>& kept = reduction.kept;
  std::size_t count = 0;
  for (const std::uint32_t k : kept) {
    const ContactCandidate& c = candidates[k];
    if (c.gap > farthest) continue;
    const auto others = std::span(kept).first(count);
    const auto twin = std::ranges::find_if(
        others, [&](std::uint32_t other) { return are_twins(candidates[other], c); });
    if (twin == others.end()) {
      kept[count++] = k;
      continue;
    }
    ContactCandidate& first = candidates[*twin];
    const double area = first.area + c.area;
    first.share_A = (first.area * first.share_A + c.area * c.share_A) / area;
    first.area = area;
  }
  kept.resize(count);
}

}  // namespace gotai::collision
