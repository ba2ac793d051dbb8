#include "gotai/render/surroundings.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gotai::render {
namespace {

const Colour kGround(0.70F, 0.72F, 0.75F);
const Colour kLine(0.42F, 0.46F, 0.52F);
const Colour kWall(0.74F, 0.79F, 0.86F);
const Colour kRim(0.26F, 0.31F, 0.40F);
const Colour kHorizon(0.83F, 0.865F, 0.905F);
const Colour kZenith(0.66F, 0.73F, 0.82F);

/// A length of 1, 2 or 5 times a power of ten near the given one.
float round_length(float length) {
  const float power = std::pow(10.0F, std::floor(std::log10(length)));
  const float lead = length / power;
  return power * (lead < 1.5F ? 1.0F : lead < 3.5F ? 2.0F : lead < 7.5F ? 5.0F : 10.0F);
}

/// How much of a pixel of this width a line of the grid covers.
float line_cover(float x, float cell, float line, float width) {
  const float from_line = std::abs(x / cell - std::round(x / cell)) * cell;
  const float cover = std::clamp((0.5F * (line + width) - from_line) / width, 0.0F, 1.0F);
  return cover * std::min(1.0F, line / width) * std::clamp(1.5F - 4.0F * width / cell, 0.0F, 1.0F);
}

}  // namespace

Vec3f sun_direction(const Vec3f& back) {
  const Vec3f flat(back.x(), back.y(), 0.0F);
  const Vec3f towards = flat.norm() > 1e-3F ? flat.normalized() : Vec3f(-Vec3f::UnitY());
  const Vec3f left = towards.cross(Vec3f::UnitZ());
  return (0.75F * left + 0.25F * towards + Vec3f::UnitZ()).normalized();
}
Colour sun_light() { return Colour(0.86F, 0.83F, 0.77F); }

Colour sky_light(const Vec3f& normal) {
  const float up = 0.5F + 0.5F * normal.z();
  return Colour(0.30F, 0.30F, 0.30F) * (1.0F - up) + Colour(0.40F, 0.43F, 0.48F) * up;
}

Colour background(const Vec3f& direction) {
  const float up = std::clamp(direction.z() * 1.6F, 0.0F, 1.0F);
  return kHorizon + std::sqrt(up) * (kZenith - kHorizon);
}

Surroundings::Surroundings(const view::RunView& run, const view::FrameView& frame,
                           const Extent& extent)
    : middle_(extent.box.center().cast<float>()),
      radius_(0.5F * static_cast<float>(extent.box.sizes().norm())),
      cell_(round_length(radius_ / 5.0F)) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < run.bodies.size(); ++i) {
    const view::BodyView& body = run.bodies[i];
    if (body.geometry == model::Geometry::shape || !frame.is_present(i)) continue;
    const Eigen::Matrix3f R = frame.q_WB[i].toRotationMatrix().cast<float>();
    const Vec3f p = frame.x_W[i].cast<float>();
    if (body.geometry == model::Geometry::plane) {
      faces_.push_back({p, R.col(0), R.col(1), R.col(2), kInfinity, kInfinity, true});
      continue;
    }
    add_container(body, p, R);
  }
  if (std::ranges::none_of(faces_, &Face::plane)) add_ground();
}

void Surroundings::add_container(const view::BodyView& body, const Vec3f& p,
                                 const Eigen::Matrix3f& R) {
  const Vec3f h = body.half_extent.cast<float>();
  const Vec3f middle = p + R.col(2) * (0.5F * h.z());
  faces_.push_back({p, R.col(0), R.col(1), R.col(2), h.x(), h.y(), false});
  for (const float side : {1.0F, -1.0F}) {
    faces_.push_back({middle + side * h.x() * R.col(0), R.col(1), R.col(2), -side * R.col(0), h.y(),
                      0.5F * h.z(), false});
    faces_.push_back({middle + side * h.y() * R.col(1), R.col(0), R.col(2), -side * R.col(1), h.x(),
                      0.5F * h.z(), false});
  }
}

void Surroundings::add_ground() {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const Face* lowest = nullptr;
  for (const Face& face : faces_) {
    const bool is_floor = face.normal.z() > 0.999F;
    if (is_floor && (lowest == nullptr || face.center.z() < lowest->center.z())) lowest = &face;
  }
  if (lowest == nullptr) return;
  faces_.push_back(
      {lowest->center, Vec3f::UnitX(), Vec3f::UnitY(), Vec3f::UnitZ(), kInfinity, kInfinity, true});
}

std::optional<Surface> Surroundings::intersect(const Vec3f& origin, const Vec3f& direction,
                                               float pixel) const {
  std::optional<Surface> nearest;
  for (const Face& face : faces_) {
    const float toward = -face.normal.dot(direction);
    if (toward <= 1e-6F) continue;  // from behind
    // A container's floor lies on the ground: it is drawn, the ground is not.
    const float bias = face.plane ? 1.0F : 0.9999F;
    const float t = bias * face.normal.dot(origin - face.center) / toward;
    if (t <= 0.0F || (nearest && t >= nearest->distance)) continue;
    const Vec3f point = origin + t * direction;
    const float u = face.axis_u.dot(point - face.center);
    const float v = face.axis_v.dot(point - face.center);
    if (std::abs(u) > face.half_u || std::abs(v) > face.half_v) continue;
    const float width = std::max(t * pixel / std::max(toward, 0.05F), 1e-9F);
    Surface surface{t, point, face.normal, kWall, 0.0F};
    if (face.plane) {
      surface.albedo = ground_colour(face, point, width);
      const float far = (point - middle_).norm() / (9.0F * radius_);
      const float x = std::clamp((far - 0.2F) / 0.8F, 0.0F, 1.0F);
      surface.haze = x * x * (3.0F - 2.0F * x);
    } else {
      const float edge = std::min(face.half_u - std::abs(u), face.half_v - std::abs(v));
      if (edge < std::max(0.0025F * radius_, t * pixel)) surface.albedo = kRim;
    }
    nearest = surface;
  }
  return nearest;
}

Colour Surroundings::ground_colour(const Face& face, const Vec3f& point, float width) const {
  const float u = face.axis_u.dot(point - face.center);
  const float v = face.axis_v.dot(point - face.center);
  const float line = 0.0022F * radius_;
  const float fine = std::max(line_cover(u, cell_, line, width), line_cover(v, cell_, line, width));
  const float bold = std::max(line_cover(u, 5.0F * cell_, 1.6F * line, width),
                              line_cover(v, 5.0F * cell_, 1.6F * line, width));
  const float ink = std::max(0.45F * fine, 0.8F * bold);
  return kGround + ink * (kLine - kGround);
}

}  // namespace gotai::render
