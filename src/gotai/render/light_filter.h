/// @file
/// Smooths the light of a picture that was sampled with few rays. Internal to render.
#pragma once

#include <vector>

#include "gotai/render/stage.h"

namespace gotai::render {

/// A pixel whose light is kept apart: colour = plain + sun_part * sun + sky_part * sky.
struct LitPixel {
  Colour plain = Colour::Zero();  ///< background and whatever else is final
  Colour sun = Colour::Zero();    ///< what the whole sun would add
  Colour sky = Colour::Zero();    ///< what the whole sky would add
  float sun_part = 0.0F;          ///< part of the sun that is seen from there, 0..1
  float sky_part = 0.0F;          ///< likewise for the sky
  Eigen::Vector3f point = Eigen::Vector3f::Zero();   ///< where the surface is [m]
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< unit
  bool solid = false;                                ///< shows one surface
};

struct LitPicture {
  LitPicture(int width_px, int height_px)
      : width(width_px),
        height(height_px),
        pixels(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px)) {}

  int width;
  int height;
  std::vector<LitPixel> pixels;
};

struct LightParts {
  float sun = 1.0F;
  float sky = 1.0F;
};

/// Averages the light parts over neighbouring pixels with a like normal that lie on the same
/// surface: within `tolerance` [m] of the plane through the point.
std::vector<LightParts> filter_light(const LitPicture& picture, float tolerance);

}  // namespace gotai::render
