// What sliding asks of the sub-stepped solver: pressure and friction spread over the patch.
#include <Eigen/Cholesky>
#include <algorithm>

#include "gotai/core/parallel.h"
#include "gotai/impulse/lanes.h"
#include "gotai/impulse/substepped.h"

namespace gotai::impulse {
namespace {

constexpr std::size_t kSharingGrain = 32;  // pairs worth a task of their own

/// Does any contact slide faster than friction could stop within the step?
bool is_sliding(const model::BodyState& bodies, const model::ContactSet& contacts,
                const model::ContactPair& pair, double stopping_speed) {
  const model::BodyIndex a = pair.body_a;
  const model::BodyIndex b = pair.body_b;
  for (std::uint32_t c = pair.begin; c < pair.end; ++c) {
    const Vec3& x = contacts.friction_W[c];
    const Vec3& n = contacts.normal_W[c];
    const Vec3 v = bodies.v_W[a] + bodies.w_W[a].cross(x - bodies.x_W[a]) - bodies.v_W[b] -
                   bodies.w_W[b].cross(x - bodies.x_W[b]);
    if ((v - n.dot(v) * n).norm() > stopping_speed) return true;
  }
  return false;
}

}  // namespace

void SubsteppedConstraint::share_loads(const model::BodyState& bodies) {
  const double stopping_speed = settings_.gravity.norm() * plan_.dt;
  parallel_for(contacts_->pairs.size(), kSharingGrain, [&](std::size_t p) {
    const model::ContactPair& pair = contacts_->pairs[p];
    if (pair.size() >= 3 && is_sliding(bodies, *contacts_, pair, stopping_speed)) share_load(pair);
  });
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
    total += static_cast<double>(rows_[slots_[c].row].p_n.value[slots_[c].lane]) * unit;
  }
  gram.diagonal().array() += 1e-6;
  const Vec6 share = gram.ldlt().solve(total) / area;
  // As far towards even as no contact has to pull: mixtures of equal wrench have equal wrench.
  double mix = 1.0;
  for (std::uint32_t c = pair.begin; c < pair.end; ++c) {
    const double even = contacts_->area[c] * wrench(c).dot(share);
    const double now = rows_[slots_[c].row].p_n.value[slots_[c].lane];
    if (even < 0.0) mix = std::min(mix, now / (now - even));
  }
  for (std::uint32_t c = pair.begin; c < pair.end; ++c) {
    float& p = rows_[slots_[c].row].p_n.value[slots_[c].lane];
    const double even = contacts_->area[c] * wrench(c).dot(share);
    p = static_cast<float>(std::max(0.0, p + mix * (even - p)));
  }
  centre_friction(pair);
}

void SubsteppedConstraint::centre_friction(const model::ContactPair& pair) {
  Vec3 offset = Vec3::Zero();
  double load = 0.0;
  for (std::uint32_t c = pair.begin; c < pair.end; ++c) {
    const double p = rows_[slots_[c].row].p_n.value[slots_[c].lane];
    offset += p * (contacts_->point_W[c] - contacts_->friction_W[c]);
    load += p;
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
