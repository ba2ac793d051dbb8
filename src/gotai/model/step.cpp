#include "gotai/model/step.h"

namespace gotai::model {

void Update::reset(std::size_t bodies, std::size_t contacts) {
  delta_v.assign(bodies, Vec3::Zero());
  delta_L.assign(bodies, Vec3::Zero());
  push_v.clear();
  push_w.clear();
  contact_impulse.assign(contacts, Vec3::Zero());
}

void Update::clear_changes() {
  delta_v.assign(delta_v.size(), Vec3::Zero());
  delta_L.assign(delta_L.size(), Vec3::Zero());
  push_v.assign(push_v.size(), Vec3::Zero());
  push_w.assign(push_w.size(), Vec3::Zero());
}

}  // namespace gotai::model
