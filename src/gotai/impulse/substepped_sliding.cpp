// What sliding asks of the sub-stepped solver: pressure and friction spread over the patch.
#include <Eigen/Cholesky>
#include <algorithm>

#include "gotai/core/parallel.h"
#include "gotai/impulse/contact_kinematics.h"
#include "gotai/impulse/lanes.h"
#include "gotai/impulse/sliding.h"
#include "gotai/impulse/substepped.h"

namespace gotai::impulse {
namespace {

constexpr std::size_t kSharingGrain = 32;  // pairs worth a task of their own

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

}  // namespace

void SubsteppedConstraint::share_loads() {
  parallel_for(contacts_->pairs.size(), kSharingGrain, [&](std::size_t p) {
    const model::ContactPair& pair = contacts_->pairs[p];
    if (is_sliding_[p] == 0) return;
    if (pair.size() >= 3) share_load(pair);
    if (sliding_shares(*contacts_, pair).empty()) centre_friction(pair);
  });
}

void SubsteppedConstraint::press_shares() {
  parallel_for(batches_.size(), kSharingGrain, [&](std::size_t k) {
    PairBatch& batch = batches_[k];
    for (std::uint32_t lane = 0; lane < batch.lanes; ++lane) {
      const std::uint32_t p = schedule_->pair[in_batch_[k].first_pair + lane];
      if (is_sliding_[p] == 0) continue;
      const auto shares = sliding_shares(*contacts_, contacts_->pairs[p]);
      if (shares.empty() || !press_shares(contacts_->pairs[p], shares)) continue;
      set(batch.pools_load, lane, 1.0);
      batch.pools_any = true;
    }
  });
}

void SubsteppedConstraint::slide(const model::ContactPair& pair, double friction, const Vec3& x_a) {
  for (const model::SlidingShare& share : sliding_shares(*contacts_, pair)) {
    const auto& [r, lane] = slots_[share.contact];
    set(rows_[r].f_a, lane, share.point_W - x_a);
    set(rows_[r].friction, lane, friction * share.alignment);
  }
}

void SubsteppedConstraint::share_load(const model::ContactPair& pair) {
  using Vec6 = Eigen::Matrix<double, 6, 1>;
  using Mat6 = Eigen::Matrix<double, 6, 6>;
  Vec3 center = Vec3::Zero();
  double area = 0.0;
  for (std::uint32_t c = pair.begin; c < pair.end; ++c) {
    center += contacts_->area[c] * contacts_->point_W[c];
    area += contacts_->area[c];
  }
  center /= area;
  double radius = 0.0;
  for (std::uint32_t c = pair.begin; c < pair.end; ++c)
    radius = std::max(radius, (contacts_->point_W[c] - center).norm());
  if (!(radius > 0.0)) return;

  // Unit wrench of a contact about the patch's centre, moments in units of its radius.
  const auto wrench = [&](std::uint32_t c) {
    Vec6 unit;
    unit << contacts_->normal_W[c],
        (contacts_->point_W[c] - center).cross(contacts_->normal_W[c]) / radius;
    return unit;
  };
  Mat6 gram = Mat6::Zero();
  Vec6 total = Vec6::Zero();
  for (std::uint32_t c = pair.begin; c < pair.end; ++c) {
    const Vec6 unit = wrench(c);
    gram.noalias() += (contacts_->area[c] / area) * unit * unit.transpose();
    total += normal_impulse(c) * unit;
  }
  gram.diagonal().array() += 1e-6;
  const Vec6 share = gram.ldlt().solve(total) / area;
  // As far towards even as no contact has to pull: mixtures of equal wrench have equal wrench.
  double mix = 1.0;
  for (std::uint32_t c = pair.begin; c < pair.end; ++c) {
    const double even = contacts_->area[c] * wrench(c).dot(share);
    const double now = normal_impulse(c);
    if (even < 0.0) mix = std::min(mix, now / (now - even));
  }
  for (std::uint32_t c = pair.begin; c < pair.end; ++c) {
    float& p = rows_[slots_[c].row].p_n.value[slots_[c].lane];
    const double even = contacts_->area[c] * wrench(c).dot(share);
    p = static_cast<float>(std::max(0.0, p + mix * (even - p)));
  }
}

bool SubsteppedConstraint::press_shares(const model::ContactPair& pair,
                                        std::span<const model::SlidingShare> shares) {
  Vec3 axis = Vec3::Zero();
  for (std::uint32_t c = pair.begin; c < pair.end; ++c)
    axis += normal_impulse(c) * contacts_->normal_W[c];
  if (axis.isZero(0.0)) return false;
  Vec3 center = Vec3::Zero();
  double area = 0.0;
  for (const model::SlidingShare& share : shares) {
    center += share.area * share.centre_W;
    area += share.area;
  }
  center /= area;
  // Pressure is linear in the patch's plane: 1, and the place in it.
  const Mat3 frame = contact_frame(axis.normalized());
  const auto place = [&](const Vec3& x) {
    return Vec3(1.0, frame.col(1).dot(x - center), frame.col(2).dot(x - center));
  };
  Mat3 gram = Mat3::Zero();
  for (const model::SlidingShare& share : shares) {
    const Vec3 at = place(share.centre_W);
    gram.noalias() += share.area * at * at.transpose();
  }
  Vec3 moments = Vec3::Zero();
  for (std::uint32_t c = pair.begin; c < pair.end; ++c)
    moments += normal_impulse(c) * place(contacts_->point_W[c]);
  // Shares on a line say nothing of the pressure across it.
  constexpr double kRidge = 1e-9;
  gram.diagonal().tail<2>().array() += kRidge * (gram(1, 1) + gram(2, 2)) + 1e-30;
  const Vec3 pressure = gram.inverse() * moments;
  const auto load = [&](const model::SlidingShare& share) {
    return std::max(0.0, share.area * pressure.dot(place(share.centre_W)));
  };
  double sum = 0.0;
  for (const model::SlidingShare& share : shares) sum += load(share);
  for (const model::SlidingShare& share : shares) {
    const auto& [r, lane] = slots_[share.contact];
    const double fraction = sum > 0.0 ? load(share) / sum : share.area / area;
    rows_[r].friction.value[lane] *= static_cast<float>(fraction);
  }
  return true;
}

void SubsteppedConstraint::centre_friction(const model::ContactPair& pair) {
  Vec3 offset = Vec3::Zero();
  double load = 0.0;
  for (std::uint32_t c = pair.begin; c < pair.end; ++c) {
    offset += normal_impulse(c) * (contacts_->point_W[c] - contacts_->friction_W[c]);
    load += normal_impulse(c);
  }
  if (!(load > 0.0)) return;
  offset /= load;
  for (std::uint32_t c = pair.begin; c < pair.end; ++c) {
    ContactRow& row = rows_[slots_[c].row];
    const std::size_t l = slots_[c].lane;
    set(row.f_a, l, get(row.f_a, l) + offset);
  }
}

}  // namespace gotai::impulse
