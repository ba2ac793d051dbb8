#include "gotai/render/light_filter.h"

#include <algorithm>
#include <cmath>

#include "gotai/core/parallel.h"

namespace gotai::render {
namespace {

constexpr int kReach = 3;  // pixels

LightParts filter_pixel(const LitPicture& picture, int x, int y, float tolerance) {
  const auto width = static_cast<std::size_t>(picture.width);
  const LitPixel& own =
      picture.pixels[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)];
  if (!own.solid) return {};
  float weights = 0.0F;
  LightParts sum{0.0F, 0.0F};
  for (int j = std::max(0, y - kReach); j <= std::min(picture.height - 1, y + kReach); ++j)
    for (int i = std::max(0, x - kReach); i <= std::min(picture.width - 1, x + kReach); ++i) {
      const LitPixel& other =
          picture.pixels[static_cast<std::size_t>(j) * width + static_cast<std::size_t>(i)];
      if (!other.solid) continue;
      const float alike = own.normal.dot(other.normal);
      const float off = std::abs(own.normal.dot(other.point - own.point));
      if (alike < 0.9F || off > tolerance) continue;
      const float near = 1.0F - static_cast<float>((i - x) * (i - x) + (j - y) * (j - y)) /
                                    static_cast<float>(3 * kReach * kReach);
      weights += near;
      sum.sun += near * other.sun_part;
      sum.sky += near * other.sky_part;
    }
  return {sum.sun / weights, sum.sky / weights};  // its own weight is 1
}

}  // namespace

std::vector<LightParts> filter_light(const LitPicture& picture, float tolerance) {
  std::vector<LightParts> parts(picture.pixels.size());
  parallel_for(static_cast<std::size_t>(picture.height), 8, [&](std::size_t y) {
    for (int x = 0; x < picture.width; ++x)
      parts[y * static_cast<std::size_t>(picture.width) + static_cast<std::size_t>(x)] =
          filter_pixel(picture, x, static_cast<int>(y), tolerance);
  });
  return parts;
}

}  // namespace gotai::render
