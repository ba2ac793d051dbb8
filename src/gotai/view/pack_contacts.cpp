#include "gotai/view/pack_contacts.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "gotai/view/pack.h"

namespace gotai::view {
namespace {

// Bytes of one contact with narrow positions and body indices.
constexpr std::size_t kContactBytes = 22;

}  // namespace

std::vector<std::size_t> strongest(const ContactsView& contacts, std::size_t count) {
  std::vector<std::size_t> order(contacts.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (count >= order.size()) return order;
  std::ranges::stable_sort(order, std::ranges::greater{},
                           [&](std::size_t i) { return contacts.impulse_W[i].squaredNorm(); });
  order.resize(count);
  std::ranges::sort(order);
  return order;
}

void ContactRanges::extend(const ContactsView& contacts) {
  for (const Vec3& point : contacts.point_W) box_.extend(point);
  counts_.push_back(contacts.size());
  total_ += contacts.size();
  most_ = std::max(most_, contacts.size());
}

std::size_t ContactRanges::limit(std::size_t budget) const {
  const auto kept = [&](std::size_t cap) {
    std::size_t sum = 0;
    for (const std::size_t count : counts_) sum += std::min(count, cap);
    return sum;
  };
  std::size_t low = 0;
  std::size_t high = most_;
  while (low < high) {
    const std::size_t middle = low + (high - low + 1) / 2;
    if (kept(middle) <= budget)
      low = middle;
    else
      high = middle - 1;
  }
  return low;
}

ContactPacker::ContactPacker(std::string name, const ContactRanges& ranges, std::size_t bodies,
                             std::size_t bytes)
    : name_(std::move(name)),
      scale_(ranges.box(), std::numeric_limits<double>::infinity()),
      limit_(ranges.limit(bytes / kContactBytes)),
      narrow_bodies_(bodies <= std::numeric_limits<std::uint16_t>::max()) {}

void ContactPacker::add(const ContactsView& contacts) {
  for (const std::size_t i : strongest(contacts, limit_)) {
    body_.push_back(contacts.body[2 * i]);
    body_.push_back(contacts.body[2 * i + 1]);
    scale_.push(contacts.point_W[i], point_);
    const auto normal = pack_normal(contacts.normal_W[i]);
    normal_.insert(normal_.end(), normal.begin(), normal.end());
    for (int k = 0; k < 3; ++k) impulse_.push_back(pack_half(contacts.impulse_W[i][k]));
    gap_.push_back(pack_half(contacts.gap[i]));
  }
  offset_.push_back(static_cast<std::uint32_t>(gap_.size()));
}

nlohmann::json ContactPacker::finish(ContainerWriter& container) const {
  container.add(name_ + ".offset", offset_);
  if (narrow_bodies_)
    container.add(name_ + ".body", std::vector<std::uint16_t>(body_.begin(), body_.end()));
  else
    container.add(name_ + ".body", body_);
  scale_.add(name_ + ".point", point_, 0, container);
  container.add(name_ + ".normal", normal_);
  container.add(name_ + ".impulse", impulse_);
  container.add(name_ + ".gap", gap_);
  return {{"position", scale_.to_json()}};
}

}  // namespace gotai::view
