/// @file
/// What one search of samples in a field leaves for the next: which samples can still matter while
/// the bodies move little. Not state: with and without it a search finds the same bits.
#pragma once

#include <cstdint>
#include <vector>

#include "gotai/collision/surface_search.h"
#include "gotai/voxel/surface_model.h"

namespace gotai::collision {

/// The packets that hold every sample with a field value of at most `margin` at one relative pose.
struct NearSamples {
  std::vector<std::uint32_t> packets;  ///< of points, ascending
  float margin = -1.0F;                ///< [m]; < 0: nothing is known
  SamplePose pose{};                   ///< of the samples in the field's frame, when it was known
  float moved = 0.0F;  ///< no sample has moved farther since, until the last search [m]

  void forget() { margin = -1.0F; }
};

/// After a search without hits: can there still be none?
/// @param moved   no sample has moved farther since that search [m]
/// @param margin  of the search that may be saved [m]
bool is_still_empty(const NearSamples& near, float moved, float margin,
                    const voxel::DistanceField& field);

/// The same hits as search_field, from the packets in `near` while no other can hold one: the
/// proof is in near_samples.cpp. When they do not suffice, all samples are searched, and `near`
/// learns which ones matter until the bodies have moved a third of a cell.
/// @param motion  the farthest that a sample is expected to move in the field until the next search
///                [m]: when the lists would not live long, none are made
void search_field(const voxel::SurfaceModel& samples, const voxel::DistanceField& field,
                  const SamplePose& pose, SearchReach reach, double motion, NearSamples& near,
                  SurfaceSearch& search);

}  // namespace gotai::collision
