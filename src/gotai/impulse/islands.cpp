#include "gotai/impulse/islands.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace gotai::impulse {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

// Root of a body's tree; halves the path on the way.
std::uint32_t root_of(std::vector<std::uint32_t>& parent, std::uint32_t body) {
  while (parent[body] != body) {
    parent[body] = parent[parent[body]];
    body = parent[body];
  }
  return body;
}

}  // namespace

std::vector<Island> find_islands(const model::BodyState& bodies,
                                 const model::ContactSet& contacts) {
  std::vector<std::uint32_t> parent(bodies.size());
  std::iota(parent.begin(), parent.end(), 0U);
  for (const model::ContactPair& pair : contacts.pairs) {
    if (!bodies.is_dynamic(pair.body_a) || !bodies.is_dynamic(pair.body_b)) continue;
    const std::uint32_t a = root_of(parent, pair.body_a);
    const std::uint32_t b = root_of(parent, pair.body_b);
    parent[std::max(a, b)] = std::min(a, b);
  }

  std::vector<Island> islands;
  std::vector<std::uint32_t> island_of(bodies.size(), none);  // by root
  for (std::uint32_t k = 0; k < contacts.pairs.size(); ++k) {
    const model::ContactPair& pair = contacts.pairs[k];
    const bool a_moves = bodies.is_dynamic(pair.body_a);
    if (!a_moves && !bodies.is_dynamic(pair.body_b)) continue;
    const std::uint32_t root = root_of(parent, a_moves ? pair.body_a : pair.body_b);
    if (island_of[root] == none) {
      island_of[root] = static_cast<std::uint32_t>(islands.size());
      islands.emplace_back();
    }
    islands[island_of[root]].pairs.push_back(k);
  }
  for (std::uint32_t body = 0; body < bodies.size(); ++body) {
    const std::uint32_t island = island_of[root_of(parent, body)];
    if (island != none) islands[island].bodies.push_back(body);
  }
  return islands;
}

}  // namespace gotai::impulse
