/// @file
/// Everything in a picture that is not a body: planes, containers, sky, light. Internal to render.
#pragma once

#include <optional>
#include <vector>

#include "gotai/render/geometry_scene.h"
#include "gotai/render/stage.h"
#include "gotai/view/run_view.h"

namespace gotai::render {

/// A point that is seen.
struct Surface {
  float distance = 0.0F;  ///< along the ray [m]
  Vec3f point = Vec3f::Zero();
  Vec3f normal = Vec3f::UnitZ();   ///< unit, towards the viewer
  Colour albedo = Colour::Zero();  ///< reflected part of the light
  float haze = 0.0F;               ///< 0: seen clearly, 1: lost in the background
};

/// Direction of the sun's middle: high, and to the left of the camera, so that shadows fall where
/// they are seen.
/// @param back  from what is looked at to the camera, unit
Vec3f sun_direction(const Vec3f& back);
/// Half of the sun's angle [rad].
inline constexpr float kSunHalfAngle = 0.045F;

/// Irradiance over pi of the sun at perpendicular incidence.
Colour sun_light();
/// Irradiance over pi of sky and ground on a surface with this normal, nothing in the way.
Colour sky_light(const Vec3f& normal);
/// What is seen where nothing is.
Colour background(const Vec3f& direction);

/// Planes and containers at a moment. Where there is no plane, a ground is drawn below the
/// containers.
class Surroundings {
 public:
  Surroundings(const view::RunView& run, const view::FrameView& frame, const Extent& extent);

  /// The nearest plane or container wall. Only their upper and inner sides are seen.
  /// @param pixel  angle between neighbouring rays [rad], for the width of lines
  std::optional<Surface> intersect(const Vec3f& origin, const Vec3f& direction, float pixel) const;

 private:
  struct Face {
    Vec3f center, axis_u, axis_v, normal;  // axes: unit
    float half_u = 0.0F;                   // infinite for planes
    float half_v = 0.0F;
    bool plane = false;
  };

  void add_container(const view::BodyView& body, const Vec3f& p, const Eigen::Matrix3f& R);
  void add_ground();
  Colour ground_colour(const Face& face, const Vec3f& point, float width) const;

  std::vector<Face> faces_;
  Vec3f middle_;
  float radius_;
  float cell_;
};

}  // namespace gotai::render
