#include "gotai/impulse/islands.h"

#include <limits>

#include "gotai/impulse/disjoint_sets.h"

namespace gotai::impulse {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

}  // namespace

void find_islands(const model::BodyState& bodies, const model::ContactSet& contacts,
                  std::vector<Island>& islands) {
  DisjointSets touching(bodies.size());
  for (const model::ContactPair& pair : contacts.pairs) {
    if (!bodies.is_dynamic(pair.body_a) || !bodies.is_dynamic(pair.body_b)) continue;
    touching.join(pair.body_a, pair.body_b);
  }

  std::size_t count = 0;
  std::vector<std::uint32_t> island_of(bodies.size(), none);  // by least body
  for (std::uint32_t k = 0; k < contacts.pairs.size(); ++k) {
    const model::ContactPair& pair = contacts.pairs[k];
    const bool a_moves = bodies.is_dynamic(pair.body_a);
    if (!a_moves && !bodies.is_dynamic(pair.body_b)) continue;
    const std::uint32_t root = touching.least(a_moves ? pair.body_a : pair.body_b);
    if (island_of[root] == none) {
      island_of[root] = static_cast<std::uint32_t>(count++);
      if (count > islands.size()) islands.emplace_back();
      islands[count - 1].bodies.clear();
      islands[count - 1].pairs.clear();
    }
    islands[island_of[root]].pairs.push_back(k);
  }
  for (std::uint32_t body = 0; body < bodies.size(); ++body) {
    const std::uint32_t island = island_of[touching.least(body)];
    if (island != none) islands[island].bodies.push_back(body);
  }
  islands.resize(count);
}

}  // namespace gotai::impulse
