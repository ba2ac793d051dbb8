#include "gotai/impulse/warm_start.h"

#include <tuple>

namespace gotai::impulse {

void recall(const model::ContactMemory& memory, const model::ContactSet& contacts,
            std::vector<Vec3>& impulse_W) {
  impulse_W.assign(contacts.size(), Vec3::Zero());
  auto entry = memory.entries.begin();
  for (const model::ContactPair& pair : contacts.pairs) {
    for (std::uint32_t i = pair.begin; i < pair.end; ++i) {
      const auto key = std::make_tuple(pair.body_a, pair.body_b, contacts.feature[i]);
      const auto key_of = [](const model::ContactMemory::Entry& e) {
        return std::make_tuple(e.body_a, e.body_b, e.feature);
      };
      while (entry != memory.entries.end() && key_of(*entry) < key) ++entry;
      if (entry == memory.entries.end()) return;
      if (key_of(*entry) == key) impulse_W[i] = entry->impulse_W;
    }
  }
}

void remember(const model::ContactSet& contacts, const std::vector<Vec3>& impulse_W,
              model::ContactMemory& memory) {
  memory.entries.clear();
  for (const model::ContactPair& pair : contacts.pairs) {
    for (std::uint32_t i = pair.begin; i < pair.end; ++i) {
      if (impulse_W[i].isZero(0.0)) continue;
      memory.entries.push_back({pair.body_a, pair.body_b, contacts.feature[i], impulse_W[i]});
    }
  }
}

}  // namespace gotai::impulse
