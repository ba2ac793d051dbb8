/// @file
/// Where bodies touch: broad phase, then the collision model that the settings name.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "gotai/collision/search_options.h"
#include "gotai/model/body_state.h"
#include "gotai/model/contact_set.h"
#include "gotai/model/settings.h"
#include "gotai/model/step.h"
#include "gotai/voxel/shape.h"

namespace gotai::collision {

/// Work done by one search.
struct SearchStatistics {
  std::uint32_t candidate_pairs = 0;  ///< from the broad phase
  std::uint64_t tests = 0;            ///< sphere-sphere and sphere-plane tests (or surface samples)
  /// Largest error of a reduction (Reduction::error): the farthest wrench of a contact left out
  /// from one that was kept; 0 when all are kept.
  double reduction_error = 0.0;
  /// The same by level (Fig. 6-8): tests_per_level[h - 1] at level h.
  std::array<std::uint64_t, voxel::kMaxLevel> tests_per_level{};
};

/// Storage that is reused between searches. Not state: deleting it changes no bit of any result.
class CollisionCache {
 public:
  CollisionCache();
  ~CollisionCache();
  CollisionCache(CollisionCache&&) noexcept;
  CollisionCache& operator=(CollisionCache&&) noexcept;

  struct Storage;
  Storage& storage() { return *storage_; }

 private:
  std::unique_ptr<Storage> storage_;
};

/// Finds the contacts of all pairs of which at least one body is dynamic.
/// @param shapes    indexed by BodyState::shape
/// @param margin    contacts are found up to this gap [m], >= 0
/// @param[out] out  sorted by (body_a, body_b, feature); storage is reused
/// @param options   of the step that the contacts are for
/// @throws InvalidArgument when the level is finer than a shape's prepared level, naming the shape
///         and both levels
SearchStatistics find_contacts(const model::BodyState& bodies,
                               std::span<const std::shared_ptr<const voxel::Shape>> shapes,
                               const model::CollisionSettings& settings, double margin,
                               CollisionCache& cache, model::ContactSet& out,
                               const SearchOptions& options = {});

}  // namespace gotai::collision
