#include "gotai/collision/find_contacts.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

#include "gotai/collision/anchored_contacts.h"
#include "gotai/collision/broad_phase.h"
#include "gotai/collision/sphere_contacts.h"
#include "gotai/collision/sphere_tree.h"
#include "gotai/collision/surface_contacts.h"
#include "gotai/core/error.h"
#include "gotai/core/parallel.h"
#include "gotai/voxel/inside.h"

namespace gotai::collision {

namespace {

using Shapes = std::span<const std::shared_ptr<const voxel::Shape>>;

/// Contacts of consecutive pairs, found by one task.
struct Chunk {
  /// A pair whose anchor was set anew while it slides: shares up to `end` in contacts.sliding, with
  /// the numbers of contacts within the pair.
  struct Slid {
    BodyPair pair;
    std::uint32_t end = 0;
  };
  model::ContactSet contacts;
  std::vector<Slid> slid;
  std::size_t begin = 0;  // place of its first contact among all
  TestCounts tests{};
  double reduction_error = 0.0;
};

// Many more tasks than threads, so that they end together; few enough that joining is cheap.
constexpr std::size_t kChunks = 256;

// What many pairs keep is read once per step, from all over the memory: asked for some pairs ahead
// it is there in time.
constexpr std::size_t kAhead = 4;

template <typename T>
void prefetch(const T* from, std::size_t count) {
  constexpr std::size_t kLine = 64;
  const auto* bytes = reinterpret_cast<const std::byte*>(from);
  for (std::size_t i = 0; i < count * sizeof(T); i += kLine) __builtin_prefetch(bytes + i);
}

void check_levels(const model::BodyState& bodies, Shapes shapes, int level) {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies.geometry[i] != model::Geometry::shape) continue;
    const voxel::Shape& shape = *shapes[bodies.shape[i]];
    if (level < 1 || level > shape.pyramid.max_level()) {
      throw InvalidArgument("collision.level", fmt::format("{}", level),
                            fmt::format("must be 1..{0}: shape '{1}' is prepared to level {0}; "
                                        "prepare it to level {2} or lower the level",
                                        shape.pyramid.max_level(), shape.name, level));
    }
  }
}

void check_surfaces(const model::BodyState& bodies, Shapes shapes) {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies.geometry[i] != model::Geometry::shape) continue;
    const voxel::Shape& shape = *shapes[bodies.shape[i]];
    if (shape.surface.empty()) {
      throw InvalidArgument("collision.model", "surface",
                            fmt::format("shape '{}' is prepared without a surface model; prepare "
                                        "it with a surface level, or use \"spheres\"",
                                        shape.name));
    }
  }
}

/// Copies the contacts of a chunk to their place in the whole.
void place(const model::ContactSet& from, std::size_t begin, model::ContactSet& to) {
  const auto at = static_cast<std::ptrdiff_t>(begin);
  const auto copy = [at](const auto& source, auto& target) {
    std::copy(source.begin(), source.end(), target.begin() + at);
  };
  copy(from.point_W, to.point_W);
  copy(from.normal_W, to.normal_W);
  copy(from.gap, to.gap);
  copy(from.anchor_A, to.anchor_A);
  copy(from.anchor_B, to.anchor_B);
  copy(from.friction_W, to.friction_W);
  copy(from.area, to.area);
  copy(from.feature, to.feature);
}

/// Joins the chunks in their order.
void join(std::span<Chunk> chunks, model::ContactSet& out) {
  out.pairs.clear();
  out.sliding.clear();
  std::size_t total = 0;
  for (Chunk& chunk : chunks) {
    chunk.begin = total;
    const auto offset = static_cast<std::uint32_t>(total);
    for (const model::ContactPair& p : chunk.contacts.pairs) {
      out.pairs.push_back({p.body_a, p.body_b, p.begin + offset, p.end + offset});
    }
    for (const model::SlidingShare& s : chunk.contacts.sliding) {
      out.sliding.push_back({s.contact + offset, s.area, s.alignment, s.centre_W, s.point_W});
    }
    total += chunk.contacts.size();
  }
  out.resize(total);
  parallel_for(chunks.size(), 8,
               [&](std::size_t c) { place(chunks[c].contacts, chunks[c].begin, out); });
}

/// The contacts of all anchors at the present poses.
void take_from_anchors(const model::BodyState& bodies, const model::ContactAnchors& anchors,
                       model::ContactSet& out) {
  constexpr std::size_t kPairsPerTask = 64;
  out.pairs.clear();
  std::uint32_t total = 0;
  for (const model::ContactAnchors::Pair& a : anchors.pairs) {
    const std::uint32_t begin = total;
    total += static_cast<std::uint32_t>(a.contacts.size());
    out.pairs.push_back({a.body_a, a.body_b, begin, total});
  }
  out.resize(total);
  parallel_for(anchors.pairs.size(), kPairsPerTask, [&](std::size_t p) {
    const std::size_t next = std::min(p + kAhead, anchors.pairs.size() - 1);
    prefetch(anchors.pairs[next].contacts.data(), anchors.pairs[next].contacts.size());
    write_anchored(anchors.pairs[p], bodies, out.pairs[p].begin, out);
  });
}

/// What the searches of anchors learnt of pairs that slide.
void take_sliding(std::span<const Chunk> chunks, model::ContactSet& out) {
  out.sliding.clear();
  auto pair = out.pairs.begin();
  for (const Chunk& chunk : chunks) {
    std::uint32_t k = 0;
    for (const Chunk::Slid& slid : chunk.slid) {
      while (pair->body_a != slid.pair.body_a || pair->body_b != slid.pair.body_b) ++pair;
      for (; k < slid.end; ++k) {
        out.sliding.push_back(chunk.contacts.sliding[k]);
        out.sliding.back().contact += pair->begin;
      }
    }
  }
}

/// The broad phase pairs bodies by the world's fastest. Drops pairs of shapes whose spheres are
/// farther apart than the two bodies can come in the step.
/// @param[out] is_distant  per pair; storage is reused
void drop_distant_pairs(const model::BodyState& bodies, double dt, double margin,
                        std::vector<std::uint8_t>& is_distant, std::vector<BodyPair>& pairs) {
  constexpr std::size_t kPairsPerTask = 256;
  is_distant.resize(pairs.size());
  parallel_for(pairs.size(), kPairsPerTask, [&](std::size_t p) {
    const BodyPair& pair = pairs[p];
    is_distant[p] = 0;
    if (bodies.geometry[pair.body_b] != model::Geometry::shape) return;
    const double touching =
        bodies.bounding_radius[pair.body_a] + bodies.bounding_radius[pair.body_b];
    const double squared = (bodies.x_W[pair.body_a] - bodies.x_W[pair.body_b]).squaredNorm();
    if (squared <= touching * touching) return;
    const PairMotion motion(bodies, pair, dt);
    const double far = touching + motion.reach(margin) + kAnchorTolerance * motion.size();
    is_distant[p] = squared > far * far ? 1 : 0;
  });
  std::size_t kept = 0;
  for (std::size_t p = 0; p < pairs.size(); ++p)
    if (is_distant[p] == 0) pairs[kept++] = pairs[p];
  pairs.resize(kept);
}

}  // namespace

struct CollisionCache::Storage {
  BroadPhase broad_phase;
  std::vector<double> radius;  // per body
  std::vector<BodyPair> candidates;
  std::vector<std::uint8_t> is_distant;  // per candidate, before those are dropped
  // Per shape. The shapes are kept alive, so that a tree is known by its shape's address.
  std::vector<std::shared_ptr<const voxel::Shape>> shapes;
  std::vector<SphereTree> trees;
  std::vector<std::unique_ptr<const ExactSurface>> exact;
  std::vector<bool> has_exact;  // exact is what the shape allows
  std::vector<Chunk> chunks;
  // What the last search of each pair leaves for the next, one per candidate of this and the last
  // step; `near` is a place in the pool, those without a pair are free.
  struct Known {
    BodyPair pair;
    std::array<std::uint32_t, 2> shape{};  // of the two bodies, when it was learnt
    std::uint32_t near = 0;
  };
  std::vector<Known> known;
  std::vector<Known> before;
  std::vector<NearPair> pool;
  std::vector<std::uint32_t> free;
  // One per candidate while the search goes on; otherwise the caller has them.
  std::vector<model::ContactAnchors::Pair> anchor;
  tbb::enumerable_thread_specific<SphereScratch> scratch;
  tbb::enumerable_thread_specific<SurfaceScratch> surface_scratch;

  void refresh_shapes(Shapes current, bool with_sphere_trees, bool with_exact_surfaces);
  void refresh_radii(const model::BodyState& bodies, const model::CollisionSettings& settings);
  void carry_over_memories(const model::BodyState& bodies);
  void forget_pairs();
  void take_anchors(model::ContactAnchors& anchors);
  void give_anchors(model::ContactAnchors& anchors);
};

// What is known of pairs stays with those that are still candidates and have the same shapes.
// Whose bodies those are does not matter: what is known holds for shapes and their relative pose.
void CollisionCache::Storage::carry_over_memories(const model::BodyState& bodies) {
  std::swap(known, before);
  known.resize(candidates.size());
  std::size_t old = 0;
  const auto drop_while = [&](const auto& is_gone) {
    while (old < before.size() && is_gone(before[old])) free.push_back(before[old++].near);
  };
  const auto key = [](const BodyPair& pair) { return std::pair(pair.body_a, pair.body_b); };
  for (std::size_t p = 0; p < candidates.size(); ++p) {
    Known& now = known[p];
    now.pair = candidates[p];
    now.shape = {bodies.shape[now.pair.body_a], bodies.shape[now.pair.body_b]};
    drop_while([&](const Known& k) {
      return key(k.pair) < key(now.pair) || (k.pair == now.pair && k.shape != now.shape);
    });
    if (old < before.size() && before[old].pair == now.pair) {
      now.near = before[old++].near;
    } else if (free.empty()) {
      now.near = static_cast<std::uint32_t>(pool.size());
      pool.emplace_back();
    } else {
      now.near = free.back();
      free.pop_back();
      pool[now.near].forget();
    }
  }
  drop_while([](const Known&) { return true; });
}

void CollisionCache::Storage::forget_pairs() {
  known.clear();
  free.resize(pool.size());
  std::iota(free.begin(), free.end(), 0U);
}

// Anchors of pairs that are no candidates any more are dropped.
void CollisionCache::Storage::take_anchors(model::ContactAnchors& anchors) {
  if (anchor.size() < candidates.size()) anchor.resize(candidates.size());
  std::size_t old = 0;
  for (std::size_t p = 0; p < candidates.size(); ++p) {
    const auto key = std::pair(candidates[p].body_a, candidates[p].body_b);
    model::ContactAnchors::Pair& now = anchor[p];
    now.contacts.clear();
    while (old < anchors.pairs.size() &&
           std::pair(anchors.pairs[old].body_a, anchors.pairs[old].body_b) < key) {
      ++old;
    }
    if (old < anchors.pairs.size() &&
        std::pair(anchors.pairs[old].body_a, anchors.pairs[old].body_b) == key) {
      std::swap(now, anchors.pairs[old++]);
    } else {
      std::tie(now.body_a, now.body_b) = key;
    }
  }
}

void CollisionCache::Storage::give_anchors(model::ContactAnchors& anchors) {
  std::size_t count = 0;
  for (std::size_t p = 0; p < candidates.size(); ++p) {
    if (anchor[p].contacts.empty()) continue;
    if (count == anchors.pairs.size()) anchors.pairs.emplace_back();
    std::swap(anchor[p], anchors.pairs[count++]);
  }
  anchors.pairs.resize(count);
}

void CollisionCache::Storage::refresh_shapes(Shapes current, bool with_sphere_trees,
                                             bool with_exact_surfaces) {
  shapes.resize(current.size());
  trees.resize(current.size());
  exact.resize(current.size());
  has_exact.resize(current.size(), false);
  for (std::size_t s = 0; s < current.size(); ++s) {
    const voxel::Shape& shape = *current[s];
    if (shapes[s] != current[s]) {
      forget_pairs();
      trees[s] = {};
      exact[s] = nullptr;
      has_exact[s] = false;
    }
    shapes[s] = current[s];
    // A shape with warnings has parts that only winding numbers tell apart.
    if (with_exact_surfaces && !has_exact[s]) {
      const bool is_simple = shape.warnings.empty() && voxel::has_closed_surface(shape.mesh);
      exact[s] = is_simple ? std::make_unique<const ExactSurface>(shape) : nullptr;
      has_exact[s] = true;
    }
    if (with_sphere_trees && trees[s].pyramid == nullptr) {
      trees[s] = make_sphere_tree(current[s]->pyramid);
    }
  }
}

void CollisionCache::Storage::refresh_radii(const model::BodyState& bodies,
                                            const model::CollisionSettings& settings) {
  radius.assign(bodies.size(), 0.0);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies.geometry[i] != model::Geometry::shape) continue;
    const voxel::Shape& shape = *shapes[bodies.shape[i]];
    radius[i] = settings.model == model::CollisionModel::surface
                    ? shape.bounding_radius
                    : shape.voxel_bounding_radius[static_cast<std::size_t>(settings.level) - 1];
  }
}

CollisionCache::CollisionCache() : storage_(std::make_unique<Storage>()) {}
CollisionCache::~CollisionCache() = default;
CollisionCache::CollisionCache(CollisionCache&&) noexcept = default;
CollisionCache& CollisionCache::operator=(CollisionCache&&) noexcept = default;

SearchStatistics find_contacts(const model::BodyState& bodies, Shapes shapes,
                               const model::CollisionSettings& settings, double margin,
                               CollisionCache& cache, model::ContactSet& out,
                               const SearchOptions& options) {
  const bool surface = settings.model == model::CollisionModel::surface;
  if (surface) {
    check_surfaces(bodies, shapes);
  } else {
    check_levels(bodies, shapes, settings.level);
  }
  CollisionCache::Storage& storage = cache.storage();
  storage.refresh_shapes(shapes, !surface,
                         surface && options.contacts == model::ContactTreatment::reduced);
  storage.refresh_radii(bodies, settings);
  storage.broad_phase.find_pairs(bodies, storage.radius, margin, storage.candidates);
  if (surface && options.dt > 0.0) {
    drop_distant_pairs(bodies, options.dt, margin, storage.is_distant, storage.candidates);
  }
  const bool anchored = surface && options.anchors != nullptr && options.dt > 0.0 &&
                        options.contacts == model::ContactTreatment::reduced;
  parallel_for(surface ? 2 : 0, 1, [&](std::size_t task) {
    if (task == 0) storage.carry_over_memories(bodies);
    if (task == 1 && anchored) storage.take_anchors(*options.anchors);
  });

  // Pairs are cut into chunks by their number alone and joined in order: the result does not depend
  // on the number of threads.
  const std::size_t pairs = storage.candidates.size();
  const std::size_t size = std::max<std::size_t>(1, (pairs + kChunks - 1) / kChunks);
  const std::size_t count = (pairs + size - 1) / size;
  if (storage.chunks.size() < count) storage.chunks.resize(count);
  parallel_for(count, 1, [&](std::size_t c) {
    Chunk& chunk = storage.chunks[c];
    chunk.contacts.clear();
    chunk.slid.clear();
    chunk.tests.fill(0);
    const std::size_t end = std::min(pairs, (c + 1) * size);
    if (surface) {
      SurfaceScratch& scratch = storage.surface_scratch.local();
      scratch.search.tests = 0;
      scratch.reduction_error = 0.0;
      for (std::size_t p = c * size; p < end; ++p) {
        prefetch(&storage.pool[storage.known[std::min(p + kAhead, pairs - 1)].near], 1);
        NearPair& near = storage.pool[storage.known[p].near];
        if (anchored) {
          refresh_anchor(bodies, shapes, storage.exact, margin, options, scratch, &near,
                         storage.anchor[p], chunk.contacts.sliding);
          const auto slid = static_cast<std::uint32_t>(chunk.contacts.sliding.size());
          if (chunk.slid.empty() ? slid > 0 : slid > chunk.slid.back().end) {
            chunk.slid.push_back({storage.candidates[p], slid});
          }
        } else {
          append_surface_contacts(bodies, storage.candidates[p], shapes, storage.exact, margin,
                                  options, scratch, chunk.contacts, &near);
        }
      }
      chunk.tests[0] = scratch.search.tests;
      chunk.reduction_error = scratch.reduction_error;
      return;
    }
    SphereScratch& scratch = storage.scratch.local();
    for (std::size_t p = c * size; p < end; ++p) {
      append_sphere_contacts(bodies, storage.candidates[p], storage.trees, settings.level, margin,
                             scratch, chunk.contacts, chunk.tests);
    }
  });

  SearchStatistics statistics;
  statistics.candidate_pairs = static_cast<std::uint32_t>(pairs);
  if (anchored) {
    storage.give_anchors(*options.anchors);
    take_from_anchors(bodies, *options.anchors, out);
    take_sliding(std::span(storage.chunks).first(count), out);
  } else {
    join(std::span(storage.chunks).first(count), out);
  }
  for (std::size_t c = 0; c < count; ++c) {
    statistics.reduction_error =
        std::max(statistics.reduction_error, storage.chunks[c].reduction_error);
    for (std::size_t h = 0; h < statistics.tests_per_level.size(); ++h) {
      statistics.tests_per_level[h] += storage.chunks[c].tests[h];
      statistics.tests += storage.chunks[c].tests[h];
    }
  }
  return statistics;
}

}  // namespace gotai::collision
