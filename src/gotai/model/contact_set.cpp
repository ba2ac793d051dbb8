#include "gotai/model/contact_set.h"

namespace gotai::model {

void ContactSet::clear() {
  pairs.clear();
  point_W.clear();
  normal_W.clear();
  gap.clear();
  anchor_A.clear();
  anchor_B.clear();
  area.clear();
  feature.clear();
}

void ContactSet::push(const Vec3& point, const Vec3& normal, double gap_m, const Vec3& a,
                      const Vec3& b, double area_m2, FeatureKey key) {
  point_W.push_back(point);
  normal_W.push_back(normal);
  gap.push_back(gap_m);
  anchor_A.push_back(a);
  anchor_B.push_back(b);
  area.push_back(area_m2);
  feature.push_back(key);
  pairs.back().end = static_cast<std::uint32_t>(gap.size());
}

}  // namespace gotai::model
