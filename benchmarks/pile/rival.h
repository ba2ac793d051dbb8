// Other engines beside ours: each steps the same pile, and is measured in the same way.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "pile/pile.h"

namespace gotai::pile {

// How a body moves, by its centre of mass.
struct Motion {
  Vec3 x_W, v_W, w_W;  // [m], [m/s], [rad/s]
  Quat q_WM;
};

// An engine's world with the pile in it.
struct Rival {
  std::string name;
  std::function<void()> step;  // by kStep
  std::function<std::vector<Motion>()> motions;
  const double* contacts;  // found so far, over all steps
};

// Steps to the end and measures.
Result simulate(const Options& options, const Pile& pile, const Rival& rival);

}  // namespace gotai::pile
