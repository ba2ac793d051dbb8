/// @file
/// The bodies as an Embree scene of instances. Internal to render.
#pragma once

#include <embree3/rtcore.h>

#include <memory>
#include <optional>
#include <vector>

#include "gotai/render/stage.h"
#include "gotai/view/run_view.h"

namespace gotai::render {

using Vec3f = Eigen::Vector3f;

/// Where a ray meets a body.
struct BodyHit {
  float distance = 0.0F;
  std::uint32_t body = 0;
  Vec3f normal = Vec3f::Zero();  ///< unit, smooth, towards the ray's origin
};

class GeometryScene {
 public:
  explicit GeometryScene(const view::RunView& run);
  ~GeometryScene();
  GeometryScene(const GeometryScene&) = delete;
  GeometryScene& operator=(const GeometryScene&) = delete;

  /// Moves all bodies; absent ones disappear.
  void place(const view::FrameView& frame);
  std::optional<BodyHit> intersect(const Vec3f& origin, const Vec3f& direction) const;
  /// Is anything within this distance?
  bool occluded(const Vec3f& origin, const Vec3f& direction, float distance) const;

 private:
  struct ShapeScene {
    RTCScene scene = nullptr;
    std::vector<Vec3f> normals;  // per corner
  };
  struct Instance {
    std::uint32_t body = 0;
    std::uint32_t shape = 0;
    RTCGeometry geometry = nullptr;
    Eigen::Matrix3f rotation = Eigen::Matrix3f::Identity();
  };

  void add_shape(const view::ShapeView& shape);

  const view::RunView& run_;
  RTCDevice device_;
  RTCScene top_;
  std::vector<ShapeScene> shapes_;
  std::vector<Instance> instances_;
};

}  // namespace gotai::render
