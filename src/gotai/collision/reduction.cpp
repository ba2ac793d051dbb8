#include "gotai/collision/reduction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace gotai::collision {
namespace {

float square(float x) { return x * x; }

class Chooser {
 public:
  Chooser(std::span<ContactCandidate> candidates, const ReductionScale& scale, Reduction& reduction)
      : candidates_(candidates), scale_(scale), reduction_(reduction) {
    const std::size_t n = candidates.size();
    reduction_.kept.clear();
    reduction_.distance.assign(n, std::numeric_limits<float>::infinity());
    reduction_.likeness.assign(n, std::numeric_limits<float>::infinity());
    reduction_.nearest.assign(n, 0);
    reduction_.reaches.resize(n);
    reduction_.weight.resize(n);
    for (std::vector<float>& part : reduction_.wrench) part.resize(n);
    for (std::uint32_t i = 1; i < n; ++i) {
      if (candidates[i].gap < candidates[deepest_].gap) deepest_ = i;
    }
    for (std::size_t i = 0; i < n; ++i) {
      const ContactCandidate& c = candidates[i];
      const Vec3 moment = c.point_A.cross(c.normal_A) / scale.length;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        reduction_.wrench[axis][i] = static_cast<float>(c.normal_A[static_cast<int>(axis)]);
        reduction_.wrench[3 + axis][i] = static_cast<float>(moment[static_cast<int>(axis)]);
      }
      reduction_.reaches[i] = static_cast<float>((c.gap - candidates[deepest_].gap) / scale.reach);
      reduction_.weight[i] = 1.0F / (1.0F + square(reduction_.reaches[i]));
    }
  }

  void keep(std::uint32_t chosen) {
    const auto position = static_cast<std::uint32_t>(reduction_.kept.size());
    reduction_.kept.push_back(chosen);
    const auto& wrench = reduction_.wrench;
    std::array<const float*, 6> w;
    std::array<float, 6> of_chosen;
    for (std::size_t k = 0; k < 6; ++k) {
      w[k] = wrench[k].data();
      of_chosen[k] = wrench[k][chosen];
    }
    const float* reaches = reduction_.reaches.data();
    const float reaches_of_chosen = reaches[chosen];
    float* distance = reduction_.distance.data();
    float* likeness = reduction_.likeness.data();
    std::uint32_t* nearest = reduction_.nearest.data();
    const std::size_t n = candidates_.size();
    for (std::size_t i = 0; i < n; ++i) {
      const float d = ((square(w[0][i] - of_chosen[0]) + square(w[1][i] - of_chosen[1])) +
                       (square(w[2][i] - of_chosen[2]) + square(w[3][i] - of_chosen[3]))) +
                      (square(w[4][i] - of_chosen[4]) + square(w[5][i] - of_chosen[5]));
      const float alike = d + square(reaches[i] - reaches_of_chosen);
      distance[i] = d < distance[i] ? d : distance[i];
      nearest[i] = alike < likeness[i] ? position : nearest[i];
      likeness[i] = alike < likeness[i] ? alike : likeness[i];
    }
    distance[chosen] = -1.0F;
    likeness[chosen] = -1.0F;
    nearest[chosen] = position;
  }

  bool is_kept(std::uint32_t i) const { return reduction_.distance[i] < 0.0F; }

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
    const auto same = static_cast<float>(scale_.resolution * scale_.resolution);
    for (;;) {
      std::uint32_t farthest = 0;
      float most_wanted = -1.0F;
      float largest = 0.0F;
      for (std::uint32_t i = 0; i < candidates_.size(); ++i) {
        const float squared = reduction_.distance[i];
        largest = std::max(largest, squared);
        if (squared <= same) continue;
        const float wanted = squared * reduction_.weight[i];
        if (wanted > most_wanted) {
          most_wanted = wanted;
          farthest = i;
        }
      }
      reduction_.error = std::sqrt(static_cast<double>(largest));
      if (reduction_.kept.size() >= kMaxReduced || most_wanted < 0.0F) return;
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
