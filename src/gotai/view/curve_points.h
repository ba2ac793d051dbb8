/// @file
/// Measurements of many steps as few points of curves. Internal to view.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "gotai/model/step.h"

namespace gotai::view {

/// One point of every curve: what several steps amount to.
struct CurvePoint {
  double time = 0.0;           ///< of the last of its steps [s]
  std::vector<double> values;  ///< in the order of curves()
};

/// Curves of at most so many points: each stands for equally many steps, and has the largest value
/// of curves that show peaks, the last value of others.
std::vector<CurvePoint> curve_points(std::span<const model::StepReport> steps, std::size_t most);

}  // namespace gotai::view
