#include "gotai/render/stage.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gotai/core/error.h"

namespace gotai::render {
namespace {

Colour from_srgb(std::uint32_t hex) {
  const auto linear = [hex](unsigned shift) {
    const float c = static_cast<float>((hex >> shift) & 255U) / 255.0F;
    return c <= 0.04045F ? c / 12.92F : std::pow((c + 0.055F) / 1.055F, 2.4F);
  };
  return {linear(16), linear(8), linear(0)};
}

Colour material_colour(std::size_t index) {
  static constexpr std::array<std::uint32_t, 10> kColours{0x5b8def, 0xf2a93b, 0x4fb286, 0xe4615a,
                                                          0x9a78d4, 0x3fb7c9, 0xd978a8, 0xa8b545,
                                                          0x8c9bb0, 0xb98a5e};
  return from_srgb(kColours[index % kColours.size()]);
}

/// From calm blue to hot red.
Colour ramp(double value) {
  static const std::array<Colour, 5> kRamp{from_srgb(0x3f5fc4), from_srgb(0x3fa4d4),
                                           from_srgb(0x63c99b), from_srgb(0xf3d04f),
                                           from_srgb(0xe5562f)};
  const double x = std::clamp(value, 0.0, 1.0) * 4.0;
  const auto i = static_cast<std::size_t>(std::min(3.0, std::floor(x)));
  const auto f = static_cast<float>(x - static_cast<double>(i));
  return kRamp[i] + f * (kRamp[i + 1] - kRamp[i]);
}

/// Neighbouring indices get hues far apart (steps of the golden ratio).
Colour index_colour(std::size_t index) {
  const auto i = static_cast<double>(index);
  const double hue = std::fmod(0.58 + i * 0.61803398875, 1.0);
  const double lightness = 0.56 + 0.06 * std::sin(i * 2.4);
  const double chroma = (1.0 - std::abs(2.0 * lightness - 1.0)) * 0.48;
  const auto channel = [&](double shift) {
    const double h = 6.0 * std::fmod(hue + shift, 1.0);
    const double wave = std::clamp(std::abs(h - 3.0) - 1.0, 0.0, 1.0);
    return static_cast<std::uint32_t>(std::lround(255.0 * (lightness + chroma * (wave - 0.5))));
  };
  return from_srgb((channel(0.0) << 16U) | (channel(2.0 / 3.0) << 8U) | channel(1.0 / 3.0));
}

double percentile(std::vector<double>& values, double part) {
  if (values.empty()) return 0.0;
  // Outwards, so that few values all count.
  const double place = part * static_cast<double>(values.size() - 1);
  const auto at = static_cast<std::size_t>(part < 0.5 ? std::floor(place) : std::ceil(place));
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(at));
  return values[at];
}

bool is_moving(const view::BodyView& body) { return body.kind != model::BodyKind::fixed; }

}  // namespace

ColourMode parse_colour_mode(std::string_view text) {
  if (text == "material") return ColourMode::material;
  if (text == "speed") return ColourMode::speed;
  if (text == "impulse") return ColourMode::impulse;
  if (text == "index") return ColourMode::index;
  throw InvalidArgument("colour", text, "must be material, speed, impulse or index");
}

std::vector<Colour> body_colours(const view::RunView& run, const view::FrameView& frame,
                                 ColourMode mode, const ColourScales& scales) {
  const std::vector<double> loads =
      mode == ColourMode::impulse ? frame.loads() : std::vector<double>{};
  std::vector<Colour> colours;
  for (std::size_t i = 0; i < run.bodies.size(); ++i) {
    if (mode == ColourMode::material)
      colours.push_back(material_colour(run.bodies[i].material));
    else if (!is_moving(run.bodies[i]))
      colours.push_back(from_srgb(0x9aa4b2));
    else if (mode == ColourMode::index)
      colours.push_back(index_colour(i));
    else if (mode == ColourMode::speed)
      colours.push_back(ramp(frame.v_W[i].norm() / scales.speed));
    else
      colours.push_back(ramp(std::sqrt(loads[i] / scales.impulse)));
  }
  return colours;
}

Extent measure(const view::RunView& run, const std::vector<view::FrameView>& moments) {
  std::array<std::vector<double>, 3> low;
  std::array<std::vector<double>, 3> high;
  std::vector<double> speeds;
  std::vector<double> loads;
  for (const view::FrameView& moment : moments) {
    const std::vector<double> load = moment.loads();
    for (std::size_t i = 0; i < run.bodies.size(); ++i) {
      if (!is_moving(run.bodies[i]) || !moment.is_present(i)) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        low[k].push_back(moment.x_W[i][static_cast<int>(k)]);
        high[k].push_back(moment.x_W[i][static_cast<int>(k)]);
      }
      speeds.push_back(moment.v_W[i].norm());
      if (load[i] > 0.0) loads.push_back(load[i]);
    }
  }
  Extent extent;
  if (const double speed = percentile(speeds, 0.98); speed > 0.0) extent.scales.speed = speed;
  if (const double impulse = percentile(loads, 0.98); impulse > 0.0)
    extent.scales.impulse = impulse;
  Box3 core;
  if (!low[0].empty())
    core =
        Box3(Vec3(percentile(low[0], 0.01), percentile(low[1], 0.01), percentile(low[2], 0.01)),
             Vec3(percentile(high[0], 0.99), percentile(high[1], 0.99), percentile(high[2], 0.99)));
  const auto add = [&](const Vec3& center, double radius) {
    extent.spheres.emplace_back(center.x(), center.y(), center.z(), radius);
    extent.box.extend(Vec3(center.array() - radius));
    extent.box.extend(Vec3(center.array() + radius));
  };
  for (const view::FrameView& moment : moments)
    for (std::size_t i = 0; i < run.bodies.size(); ++i) {
      const view::BodyView& body = run.bodies[i];
      if (!moment.is_present(i) || body.geometry == model::Geometry::plane) continue;
      if (body.geometry == model::Geometry::container) {
        for (int corner = 0; corner < 8; ++corner)
          add(moment.x_W[i] +
                  moment.q_WB[i] *
                      Vec3((corner & 1) != 0 ? body.half_extent.x() : -body.half_extent.x(),
                           (corner & 2) != 0 ? body.half_extent.y() : -body.half_extent.y(),
                           (corner & 4) != 0 ? body.half_extent.z() : 0.0),
              0.0);
      } else if (!is_moving(body) || core.contains(moment.x_W[i])) {
        add(moment.x_W[i], body.radius);
      }
    }
  if (extent.spheres.empty()) add(Vec3::Zero(), 1.0);
  return extent;
}

Camera frame_camera(const Extent& extent, const Vec3& from, double aspect, double zoom) {
  Camera camera;
  const Vec3 back = from.normalized();
  const Vec3 right = Vec3::UnitZ().cross(back).norm() > 1e-6
                         ? Vec3(Vec3::UnitZ().cross(back).normalized())
                         : Vec3(Vec3::UnitX());
  const Vec3 up = back.cross(right);
  const double tan_v = std::tan(camera.vertical_angle / 2.0);
  const double tan_h = tan_v * aspect;
  const double margin = 1.06;
  camera.target = extent.box.center();
  double distance = 0.0;
  // Twice: the first pass finds where the middle of the picture is.
  for (int pass = 0; pass < 3; ++pass) {
    distance = 0.0;
    double left = std::numeric_limits<double>::infinity();
    double bottom = left;
    double rightmost = -left;
    double top = -left;
    for (const Eigen::Vector4d& sphere : extent.spheres) {
      const Vec3 p = sphere.head<3>() - camera.target;
      const double r = margin * sphere.w();
      const double x = right.dot(p);
      const double y = up.dot(p);
      const double z = back.dot(p);
      distance =
          std::max({distance, (margin * std::abs(x) + r / std::cos(std::atan(tan_h))) / tan_h + z,
                    (margin * std::abs(y) + r / std::cos(std::atan(tan_v))) / tan_v + z});
      left = std::min(left, x - r);
      rightmost = std::max(rightmost, x + r);
      bottom = std::min(bottom, y - r);
      top = std::max(top, y + r);
    }
    if (pass < 2) camera.target += 0.5 * ((left + rightmost) * right + (bottom + top) * up);
  }
  camera.position = camera.target + back * (distance / zoom);
  return camera;
}

}  // namespace gotai::render
