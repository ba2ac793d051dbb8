#include "gotai/collision/find_contacts.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>

#include "gotai/collision/broad_phase.h"
#include "gotai/collision/sphere_contacts.h"
#include "gotai/collision/sphere_tree.h"
#include "gotai/core/error.h"
#include "gotai/core/parallel.h"

namespace gotai::collision {

namespace {

using Shapes = std::span<const std::shared_ptr<const voxel::Shape>>;

/// Contacts of consecutive pairs, found by one task.
struct Chunk {
  model::ContactSet contacts;
  std::size_t begin = 0;  // place of its first contact among all
  TestCounts tests{};
};

// Many more tasks than threads, so that they end together; few enough that joining is cheap.
constexpr std::size_t kChunks = 256;

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
  copy(from.area, to.area);
  copy(from.feature, to.feature);
}

/// Joins the chunks in their order.
void join(std::span<Chunk> chunks, model::ContactSet& out) {
  out.pairs.clear();
  std::size_t total = 0;
  for (Chunk& chunk : chunks) {
    chunk.begin = total;
    const auto offset = static_cast<std::uint32_t>(total);
    for (const model::ContactPair& p : chunk.contacts.pairs) {
      out.pairs.push_back({p.body_a, p.body_b, p.begin + offset, p.end + offset});
    }
    total += chunk.contacts.size();
  }
  out.resize(total);
  parallel_for(chunks.size(), 8,
               [&](std::size_t c) { place(chunks[c].contacts, chunks[c].begin, out); });
}

}  // namespace

struct CollisionCache::Storage {
  BroadPhase broad_phase;
  std::vector<double> radius;  // per body
  std::vector<BodyPair> candidates;
  // Per shape. The shapes are kept alive, so that a tree is known by its shape's address.
  std::vector<std::shared_ptr<const voxel::Shape>> shapes;
  std::vector<SphereTree> trees;
  std::vector<Chunk> chunks;
  tbb::enumerable_thread_specific<SphereScratch> scratch;

  void refresh_trees(Shapes current);
  void refresh_radii(const model::BodyState& bodies, int level);
};

void CollisionCache::Storage::refresh_trees(Shapes current) {
  shapes.resize(current.size());
  trees.resize(current.size());
  for (std::size_t s = 0; s < current.size(); ++s) {
    if (shapes[s] == current[s]) continue;
    trees[s] = make_sphere_tree(current[s]->pyramid);
    shapes[s] = current[s];
  }
}

void CollisionCache::Storage::refresh_radii(const model::BodyState& bodies, int level) {
  radius.assign(bodies.size(), 0.0);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies.geometry[i] != model::Geometry::shape) continue;
    radius[i] = shapes[bodies.shape[i]]->voxel_bounding_radius[static_cast<std::size_t>(level) - 1];
  }
}

CollisionCache::CollisionCache() : storage_(std::make_unique<Storage>()) {}
CollisionCache::~CollisionCache() = default;
CollisionCache::CollisionCache(CollisionCache&&) noexcept = default;
CollisionCache& CollisionCache::operator=(CollisionCache&&) noexcept = default;

SearchStatistics find_contacts(const model::BodyState& bodies, Shapes shapes,
                               const model::CollisionSettings& settings, double margin,
                               CollisionCache& cache, model::ContactSet& out) {
  if (settings.model != model::CollisionModel::spheres) {
    throw InvalidArgument("collision.model", model::to_string(settings.model),
                          "must be \"spheres\"");
  }
  check_levels(bodies, shapes, settings.level);
  CollisionCache::Storage& storage = cache.storage();
  storage.refresh_trees(shapes);
  storage.refresh_radii(bodies, settings.level);
  storage.broad_phase.find_pairs(bodies, storage.radius, margin, storage.candidates);

  // Pairs are cut into chunks by their number alone and joined in order: the result does not depend
  // on the number of threads.
  const std::size_t pairs = storage.candidates.size();
  const std::size_t size = std::max<std::size_t>(1, (pairs + kChunks - 1) / kChunks);
  const std::size_t count = (pairs + size - 1) / size;
  if (storage.chunks.size() < count) storage.chunks.resize(count);
  parallel_for(count, 1, [&](std::size_t c) {
    Chunk& chunk = storage.chunks[c];
    SphereScratch& scratch = storage.scratch.local();
    chunk.contacts.clear();
    chunk.tests.fill(0);
    for (std::size_t p = c * size; p < std::min(pairs, (c + 1) * size); ++p) {
      append_sphere_contacts(bodies, storage.candidates[p], storage.trees, settings.level, margin,
                             scratch, chunk.contacts, chunk.tests);
    }
  });

  SearchStatistics statistics;
  statistics.candidate_pairs = static_cast<std::uint32_t>(pairs);
  join(std::span(storage.chunks).first(count), out);
  for (std::size_t c = 0; c < count; ++c) {
    for (std::size_t h = 0; h < statistics.tests_per_level.size(); ++h) {
      statistics.tests_per_level[h] += storage.chunks[c].tests[h];
      statistics.tests += storage.chunks[c].tests[h];
    }
  }
  return statistics;
}

}  // namespace gotai::collision
