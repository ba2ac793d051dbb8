/// @file
/// Few contacts that can carry what many can: the geometric heir of the apparent contact point
/// [Makino 2007, chapter 5].
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "gotai/collision/sliding_shares.h"
#include "gotai/collision/wrench_lanes.h"
#include "gotai/model/contact_memory.h"

namespace gotai::collision {

inline constexpr std::size_t kMaxRemembered = 5;

/// Sizes that a reduction works with.
struct ReductionScale {
  double length = 1.0;       ///< of the smaller body [m]: moments are counted in units of it
  double depth_step = 0.0;   ///< a deeper contact replaces remembered ones only beyond this [m]
  double resolution = 0.04;  ///< wrenches nearer than this are one (dimensionless)
  /// Contacts whose gaps differ by more than this do not carry at the same time [m].
  double reach = std::numeric_limits<double>::infinity();
};

/// Storage of a reduction.
struct Reduction {
  std::vector<std::uint32_t> kept;  ///< indices of the candidates kept, ascending
  /// Every unit wrench of a candidate, (normal, arm x normal / length), is nearer than this to one
  /// that is kept: the error of any load is at most this times the sum of its impulses.
  double error = 0.0;
  /// Of the kept contacts, if the patch is flat and slides; otherwise empty.
  std::vector<ShareFriction> sliding;
  WrenchLanes lanes;
};

/// Chooses at most kMaxReduced candidates: those that carried the largest impulses in the last step
/// (at most kMaxRemembered), the deepest, then again and again the one whose wrench is farthest
/// from all that were chosen, where those that are farther from touching count less. The others
/// give their area to the chosen one that is most alike in wrench and gap, whose share becomes the
/// centre of that area. Ties go to the smaller index, so the choice is stable.
/// @param[in,out] candidates  ascending by feature; area and share_A of kept ones are updated,
///                            the areas of others become 0
/// @param remembered          the pair's entries of the last step, ascending by feature
/// @param slip                how the bodies move; null: nothing slides
void reduce_contacts(std::span<ContactCandidate> candidates,
                     std::span<const model::ContactMemory::Entry> remembered,
                     const ReductionScale& scale, Reduction& reduction,
                     const SlipField* slip = nullptr);

/// Drops kept contacts that turned out to be farther than they looked, and of those that are the
/// same all but the first, which gets their areas: where edges cross, several samples of both
/// bodies tell of one contact. Flat patches that slide stay as they are.
/// @param farthest  gap [m]
/// @param length    of the bodies [m]
void drop_far_and_twins(std::span<ContactCandidate> candidates, double farthest, double length,
                        Reduction& reduction);

}  // namespace gotai::collision
