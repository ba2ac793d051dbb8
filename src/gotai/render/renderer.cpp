#include "gotai/render/renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "gotai/core/error.h"
#include "gotai/core/parallel.h"
#include "gotai/render/geometry_scene.h"
#include "gotai/render/light_filter.h"
#include "gotai/render/surroundings.h"

namespace gotai::render {
namespace {

/// Evenly spread numbers in [0, 1): two per index [Roberts' R2 sequence], shifted for each pixel.
class Spread {
 public:
  Spread(int x, int y) {
    // A gradient noise [Jimenez 2014] that differs well between neighbours.
    const auto noise = [](float a, float b) {
      const float inner = 0.06711056F * a + 0.00583715F * b;
      const float value = 52.9829189F * (inner - std::floor(inner));
      return value - std::floor(value);
    };
    u_ = noise(static_cast<float>(x), static_cast<float>(y));
    v_ = noise(static_cast<float>(y) + 47.0F, static_cast<float>(x) + 17.0F);
  }
  std::array<float, 2> at(int index) const {
    const float u = u_ + 0.75487767F * static_cast<float>(index);
    const float v = v_ + 0.56984029F * static_cast<float>(index);
    return {u - std::floor(u), v - std::floor(v)};
  }

 private:
  float u_;
  float v_;
};

/// A direction around an axis: radius (0..1) and turn (0..1) on the unit disc, lifted so that
/// 1 means `sine` off the axis.
Vec3f around(const Vec3f& axis, float radius, float turn, float sine) {
  const Vec3f side = std::abs(axis.z()) < 0.9F ? Vec3f::UnitZ().cross(axis).normalized()
                                               : Vec3f::UnitX().cross(axis).normalized();
  const Vec3f other = axis.cross(side);
  const float angle = 2.0F * std::numbers::pi_v<float> * turn;
  const float r = radius * sine;
  return r * std::cos(angle) * side + r * std::sin(angle) * other +
         std::sqrt(std::max(0.0F, 1.0F - r * r)) * axis;
}

/// Keeps colours up to 0.8 as they are and bends brighter ones below 1, losing saturation as the
/// eye does [Khronos PBR Neutral, without what it takes off for reflections: there are none].
Colour tone_map(Colour c) {
  constexpr float kStart = 0.8F;
  const float peak = c.maxCoeff();
  if (peak < kStart) return c;
  constexpr float d = 1.0F - kStart;
  const float bent = 1.0F - d * d / (peak + d - kStart);
  c *= bent / peak;
  const float grey = 1.0F - 1.0F / (0.15F * (peak - bent) + 1.0F);
  return c + grey * (Colour::Constant(bent) - c);
}

std::uint8_t to_srgb(float linear) {
  const float c = std::clamp(linear, 0.0F, 1.0F);
  const float s = c <= 0.0031308F ? 12.92F * c : 1.055F * std::pow(c, 1.0F / 2.4F) - 0.055F;
  return static_cast<std::uint8_t>(std::lround(255.0F * s));
}

}  // namespace

struct Renderer::State {
  State(const view::RunView& run_view, const RenderOptions& render_options)
      : run(run_view), options(render_options), scene(run_view) {}

  const view::RunView& run;
  RenderOptions options;
  GeometryScene scene;
};

Renderer::Renderer(const view::RunView& run, const RenderOptions& options) {
  if (options.width < 16 || options.height < 16 || options.width > 8192 || options.height > 8192)
    throw InvalidArgument("size", fmt::format("{}x{}", options.width, options.height),
                          "must be between 16x16 and 8192x8192");
  if (options.samples < 1 || options.samples > 8)
    throw InvalidArgument("samples", std::to_string(options.samples), "must be between 1 and 8");
  state_ = std::make_unique<State>(run, options);
}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;

namespace {

/// Draws one pixel at a time.
class Tracer {
 public:
  Tracer(const GeometryScene& scene, const Surroundings& surroundings,
         const std::vector<Colour>& colours, const Camera& camera, const Extent& extent,
         const RenderOptions& options)
      : scene_(scene),
        surroundings_(surroundings),
        colours_(colours),
        options_(options),
        eye_(camera.position.cast<float>()) {
    const Vec3 forward = (camera.target - camera.position).normalized();
    const Vec3 right = forward.cross(Vec3::UnitZ()).norm() > 1e-6
                           ? Vec3(forward.cross(Vec3::UnitZ()).normalized())
                           : Vec3(Vec3::UnitX());
    pixel_ = static_cast<float>(2.0 * std::tan(camera.vertical_angle / 2.0) / options.height);
    forward_ = forward.cast<float>();
    right_ = right.cast<float>();
    down_ = forward.cross(right).cast<float>();
    radius_ = 0.5F * static_cast<float>(extent.box.sizes().norm());
    sun_ = sun_direction(-forward_);
  }

  LitPixel trace(int x, int y) const {
    LitPixel pixel;
    const Spread spread(x, y);
    const int n = options_.samples;
    float sun_weight = 0.0F;
    float sky_weight = 0.0F;
    Colour lit = Colour::Zero();  // sun and sky as these few samples see them
    bool mixed = false;           // are there several surfaces in this pixel?
    for (int s = 0; s < n * n; ++s) {
      const int column = s % n;
      const int row = s / n;
      const float px = static_cast<float>(x) +
                       (static_cast<float>(column) + 0.5F) / static_cast<float>(n) -
                       0.5F * static_cast<float>(options_.width);
      const float py = static_cast<float>(y) +
                       (static_cast<float>(row) + 0.5F) / static_cast<float>(n) -
                       0.5F * static_cast<float>(options_.height);
      const Vec3f direction = (forward_ + pixel_ * (px * right_ + py * down_)).normalized();
      const std::optional<Surface> surface = look(direction);
      if (!surface) {
        pixel.plain += background(direction);
        continue;
      }
      if (sky_weight == 0.0F) {
        pixel.point = surface->point;
        pixel.normal = surface->normal;
      } else if (!on_same_surface(pixel, *surface)) {
        mixed = true;
      }
      const float clear = 1.0F - surface->haze;
      const float facing = std::max(0.0F, surface->normal.dot(sun_));
      const Colour sun = clear * facing * surface->albedo.cwiseProduct(sun_light());
      const Colour sky = clear * surface->albedo.cwiseProduct(sky_light(surface->normal));
      const Vec3f origin = surface->point + 2e-4F * radius_ * surface->normal;
      const auto [u, v] = spread.at(s);
      if (facing > 0.0F) {
        const Vec3f to_sun = around(sun_, std::sqrt(u), v, kSunHalfAngle);
        if (!scene_.occluded(origin, to_sun, 20.0F * radius_)) {
          pixel.sun_part += sun.sum();
          lit += sun;
        }
      }
      const Vec3f to_sky = around(surface->normal, std::sqrt(v), u, 1.0F);
      if (!scene_.occluded(origin, to_sky, 0.5F * radius_)) {
        pixel.sky_part += sky.sum();
        lit += sky;
      }
      sun_weight += sun.sum();
      sky_weight += sky.sum();
      pixel.sun += sun;
      pixel.sky += sky;
      pixel.plain += surface->haze * background(direction);
    }
    pixel.sun_part = sun_weight > 0.0F ? pixel.sun_part / sun_weight : 1.0F;
    pixel.sky_part = sky_weight > 0.0F ? pixel.sky_part / sky_weight : 1.0F;
    pixel.solid = sky_weight > 0.0F && !mixed;
    const float part = 1.0F / static_cast<float>(n * n);
    if (mixed) {
      // What one surface sees of the sun says nothing about the other: no filter here.
      pixel.plain += lit;
      pixel.sun.setZero();
      pixel.sky.setZero();
    }
    pixel.sun *= part;
    pixel.sky *= part;
    pixel.plain *= part;
    return pixel;
  }

 private:
  bool on_same_surface(const LitPixel& pixel, const Surface& surface) const {
    return pixel.normal.dot(surface.normal) > 0.9F &&
           std::abs(pixel.normal.dot(surface.point - pixel.point)) < 0.01F * radius_;
  }

  std::optional<Surface> look(const Vec3f& direction) const {
    std::optional<Surface> surface = surroundings_.intersect(eye_, direction, pixel_);
    const std::optional<BodyHit> hit = scene_.intersect(eye_, direction);
    if (hit && (!surface || hit->distance < surface->distance))
      surface = Surface{hit->distance, eye_ + hit->distance * direction, hit->normal,
                        colours_[hit->body], 0.0F};
    return surface;
  }

  const GeometryScene& scene_;
  const Surroundings& surroundings_;
  const std::vector<Colour>& colours_;
  const RenderOptions& options_;
  Vec3f eye_, forward_, right_, down_;
  Vec3f sun_;            // unit, to its middle
  float pixel_ = 0.0F;   // angle of a pixel in the middle [rad]
  float radius_ = 0.0F;  // of the world [m]
};

}  // namespace

Picture Renderer::draw(const view::FrameView& frame, const std::vector<Colour>& colours,
                       const Camera& camera, const Extent& extent) {
  const RenderOptions& options = state_->options;
  state_->scene.place(frame);
  const Surroundings surroundings(state_->run, frame, extent);
  const Tracer tracer(state_->scene, surroundings, colours, camera, extent, options);
  const auto width = static_cast<std::size_t>(options.width);
  const auto height = static_cast<std::size_t>(options.height);

  LitPicture lit(options.width, options.height);
  parallel_for(height, 4, [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x)
      lit.pixels[y * width + x] = tracer.trace(static_cast<int>(x), static_cast<int>(y));
  });
  // Neighbours on the same surface share their few samples of sun and sky.
  const double tolerance = 0.004 * extent.box.sizes().norm();
  const std::vector<LightParts> parts = filter_light(lit, static_cast<float>(tolerance));

  Picture picture(options.width, options.height);
  parallel_for(height, 16, [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x) {
      const LitPixel& pixel = lit.pixels[y * width + x];
      const LightParts& part = parts[y * width + x];
      const Colour colour = tone_map(pixel.plain + part.sun * pixel.sun + part.sky * pixel.sky);
      for (int k = 0; k < 3; ++k)
        picture.pixel(static_cast<int>(x), static_cast<int>(y))[k] = to_srgb(colour[k]);
    }
  });
  return picture;
}

}  // namespace gotai::render
