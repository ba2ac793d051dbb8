#include "gotai/model/contact_set.h"

#include <cmath>
#include <string>

#include "gotai/core/error.h"

namespace gotai::model {

void ContactSet::clear() {
  pairs.clear();
  point_W.clear();
  normal_W.clear();
  gap.clear();
  anchor_A.clear();
  anchor_B.clear();
  friction_W.clear();
  area.clear();
  feature.clear();
  sliding.clear();
}

void ContactSet::resize(std::size_t count) {
  point_W.resize(count);
  normal_W.resize(count);
  gap.resize(count);
  anchor_A.resize(count);
  anchor_B.resize(count);
  friction_W.resize(count);
  area.resize(count);
  feature.resize(count);
}

void ContactSet::push(const Vec3& point, const Vec3& normal, double gap_m, const Vec3& a,
                      const Vec3& b, double area_m2, FeatureKey key) {
  point_W.push_back(point);
  normal_W.push_back(normal);
  gap.push_back(gap_m);
  anchor_A.push_back(a);
  anchor_B.push_back(b);
  friction_W.push_back(point);
  area.push_back(area_m2);
  feature.push_back(key);
  pairs.back().end = static_cast<std::uint32_t>(gap.size());
}

void refresh_gaps(const BodyState& bodies, const ContactSet& contacts, std::vector<double>& gap) {
  gap.resize(contacts.size());
  for (const ContactPair& pair : contacts.pairs) {
    const Vec3& x_A = bodies.x_W[pair.body_a];
    const Vec3& x_B = bodies.x_W[pair.body_b];
    const Mat3 R_A = bodies.q_WB[pair.body_a].toRotationMatrix();
    const Mat3 R_B = bodies.q_WB[pair.body_b].toRotationMatrix();
    for (std::uint32_t i = pair.begin; i < pair.end; ++i) {
      const Vec3 separation =
          (x_A - x_B) + (R_A * contacts.anchor_A[i] - R_B * contacts.anchor_B[i]);
      gap[i] = contacts.normal_W[i].dot(separation);
    }
  }
}

void validate(const ContactSet& contacts, std::size_t body_count) {
  const std::size_t n = contacts.size();
  if (contacts.point_W.size() != n || contacts.normal_W.size() != n ||
      contacts.anchor_A.size() != n || contacts.anchor_B.size() != n || contacts.area.size() != n ||
      contacts.feature.size() != n)
    throw SimulationError("contact arrays have different lengths");
  std::uint32_t expected_begin = 0;
  for (std::size_t k = 0; k < contacts.pairs.size(); ++k) {
    const ContactPair& pair = contacts.pairs[k];
    const auto fail = [k](const char* what) {
      throw SimulationError("contact pair " + std::to_string(k) + ": " + what);
    };
    if (pair.body_a >= body_count || pair.body_b >= body_count || pair.body_a == pair.body_b)
      fail("impossible bodies");
    if (pair.begin != expected_begin || pair.end <= pair.begin || pair.end > n) fail("bad range");
    expected_begin = pair.end;
    if (k > 0) {
      const ContactPair& before = contacts.pairs[k - 1];
      if (std::pair(before.body_a, before.body_b) >= std::pair(pair.body_a, pair.body_b))
        fail("pairs are not sorted");
    }
    for (std::uint32_t i = pair.begin; i < pair.end; ++i) {
      if (i > pair.begin && contacts.feature[i - 1] >= contacts.feature[i])
        fail("features are not sorted");
      if (!(std::abs(contacts.normal_W[i].norm() - 1.0) < 1e-9)) fail("a normal is not unit");
      if (!std::isfinite(contacts.gap[i]) || !contacts.point_W[i].allFinite())
        fail("a contact is not finite");
    }
  }
  if (expected_begin != n) throw SimulationError("contacts without a pair");
  for (std::size_t k = 0; k < contacts.sliding.size(); ++k) {
    const SlidingShare& share = contacts.sliding[k];
    if (share.contact >= n || (k > 0 && contacts.sliding[k - 1].contact >= share.contact) ||
        !(share.area > 0.0) || !(share.alignment >= 0.0 && share.alignment <= 1.0) ||
        !share.point_W.allFinite())
      throw SimulationError("sliding share " + std::to_string(k) + " is not valid");
  }
}

}  // namespace gotai::model
