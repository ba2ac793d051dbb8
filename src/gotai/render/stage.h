/// @file
/// What is in a picture: bodies, planes, containers, camera, and how bodies are coloured.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "gotai/core/types.h"
#include "gotai/view/run_view.h"

namespace gotai::render {

using Colour = Eigen::Vector3f;  ///< linear RGB, 0..1

/// How bodies are coloured; the same as in the viewer.
enum class ColourMode : std::uint8_t { material, speed, impulse, index };
/// @throws InvalidArgument listing the allowed names
ColourMode parse_colour_mode(std::string_view text);

/// The values that are drawn hottest.
struct ColourScales {
  double speed = 1.0;    ///< [m/s]
  double impulse = 1.0;  ///< [N s]
};

/// Colours of all bodies at a moment.
std::vector<Colour> body_colours(const view::RunView& run, const view::FrameView& frame,
                                 ColourMode mode, const ColourScales& scales);

/// A pinhole camera with z up in the picture.
struct Camera {
  Vec3 position = Vec3(3.0, -5.0, 2.5);  ///< [m], W
  Vec3 target = Vec3::Zero();            ///< [m], W
  double vertical_angle = 0.6;           ///< of the whole picture [rad]
};

/// What the whole run is measured by, so that pictures of different moments go together.
struct Extent {
  std::vector<Eigen::Vector4d> spheres;  ///< centre and radius of what must be in the picture [m]
  Box3 box;                              ///< around them
  ColourScales scales;
};

/// Measures a run at these moments. Bodies that fly off (the outermost hundredth) do not count.
Extent measure(const view::RunView& run, const std::vector<view::FrameView>& moments);

/// The camera from a direction that holds the whole extent.
/// @param from    direction from the target to the camera; need not be unit
/// @param aspect  width / height of the picture
/// @param zoom    > 1 comes nearer
Camera frame_camera(const Extent& extent, const Vec3& from, double aspect, double zoom);

}  // namespace gotai::render
