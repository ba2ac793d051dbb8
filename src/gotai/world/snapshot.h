/// @file
/// The state of a world between two steps: what a checkpoint holds and what the state hash covers.
#pragma once

#include <cstdint>
#include <vector>

#include "gotai/core/types.h"
#include "gotai/model/contact_anchors.h"
#include "gotai/model/contact_memory.h"

namespace gotai {

/// Everything that changes from step to step. With the scene that made the world it is enough to go
/// on bit for bit. Arrays have one entry per body, in column order.
struct Snapshot {
  double time = 0.0;     ///< [s]
  double last_dt = 0.0;  ///< size of the last step [s]; the energy of a step refers to it
  std::uint64_t step_count = 0;
  std::vector<Vec3> x_W;          ///< centre of mass [m]
  std::vector<Quat> q_WB;         ///< orientation
  std::vector<Vec3> v_W;          ///< velocity [m/s]
  std::vector<Vec3> L_W;          ///< angular momentum [kg m^2/s]
  std::vector<Vec3> w_W;          ///< angular velocity [rad/s]
  model::ContactMemory memory;    ///< impulses for the warm start
  model::ContactAnchors anchors;  ///< contacts of pairs that may rest
};

}  // namespace gotai
