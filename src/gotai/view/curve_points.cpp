#include "gotai/view/curve_points.h"

#include <algorithm>

#include "gotai/view/run_view.h"

namespace gotai::view {

std::vector<CurvePoint> curve_points(std::span<const model::StepReport> steps, std::size_t most) {
  const std::size_t bucket = std::max<std::size_t>(1, (steps.size() + most - 1) / most);
  std::vector<CurvePoint> points;
  for (std::size_t i = 0; i < steps.size(); i += bucket) {
    const auto part = steps.subspan(i, std::min(bucket, steps.size() - i));
    CurvePoint point{part.back().time, {}};
    for (const Curve& curve : curves()) {
      double value = curve.value(part.back());
      if (curve.peak)
        for (const model::StepReport& step : part) value = std::max(value, curve.value(step));
      point.values.push_back(value);
    }
    points.push_back(std::move(point));
  }
  return points;
}

}  // namespace gotai::view
