/// @file
/// Positions as integers over a box. Internal to view.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "gotai/core/types.h"
#include "gotai/view/container.h"

namespace gotai::view {

/// Coordinates are origin + step * integer.
class PositionScale {
 public:
  /// @param box   of all positions [m]; may be empty
  /// @param fine  a length whose thousandth must not be lost [m]: beyond 16 bits it takes 32
  PositionScale(const Box3& box, double fine) {
    if (!box.isEmpty()) {
      origin_ = box.min();
      sizes_ = box.sizes();
    }
    wide_ = sizes_.maxCoeff() / 65535.0 > 2e-3 * fine;
    max_ = wide_ ? 4294967295.0 : 65535.0;
    step_ = (sizes_ / max_).cwiseMax(1e-300);
  }

  void push(const Vec3& x, std::vector<std::uint32_t>& out) const {
    for (int k = 0; k < 3; ++k) {
      const double steps = std::clamp((x[k] - origin_[k]) / step_[k], 0.0, max_);
      out.push_back(static_cast<std::uint32_t>(std::llround(steps)));
    }
  }

  /// Adds the array with as few bits as it takes.
  void add(const std::string& name, const std::vector<std::uint32_t>& values, std::size_t stride,
           ContainerWriter& container) const {
    if (wide_) {
      container.add(name, values, stride);
      return;
    }
    std::vector<std::uint16_t> narrow(values.size());
    std::ranges::transform(values, narrow.begin(),
                           [](std::uint32_t value) { return static_cast<std::uint16_t>(value); });
    container.add(name, narrow, stride);
  }

  /// Largest distance between a position and its rounded form [m].
  double error() const { return 0.5 * (sizes_ / max_).norm(); }

  nlohmann::json to_json() const {
    return {{"origin", {origin_.x(), origin_.y(), origin_.z()}},
            {"step", {step_.x(), step_.y(), step_.z()}}};
  }

 private:
  Vec3 origin_ = Vec3::Zero();
  Vec3 sizes_ = Vec3::Zero();
  Vec3 step_ = Vec3::Zero();
  double max_ = 65535.0;
  bool wide_ = false;
};

}  // namespace gotai::view
