#include "svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace gotai::experiments {
namespace {

constexpr std::array<const char*, 10> kColors{"#1f6fb4", "#d1495b", "#2a9d64", "#e08e1b",
                                              "#7a5bb5", "#12a3a8", "#8c564b", "#c2569b",
                                              "#6b7280", "#98a62b"};
constexpr std::size_t kPointsPerLine = 500;  // as many as can be told apart
constexpr double kWidth = 640.0;
constexpr double kHeight = 400.0;
constexpr double kLeft = 78.0;
constexpr double kRight = 20.0;
constexpr double kTop = 40.0;
constexpr double kBottom = 56.0;

/// One axis: data range, scale and ticks.
struct Axis {
  bool log = false;
  double low = 0.0;
  double high = 1.0;
  std::vector<double> ticks;

  double fraction(double v) const {
    if (log) return (std::log10(v) - std::log10(low)) / (std::log10(high) - std::log10(low));
    return (v - low) / (high - low);
  }
};

bool drawable(double v, bool log) { return std::isfinite(v) && (!log || v > 0.0); }

double nice_step(double range) {
  const double raw = range / 5.0;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double lead = raw / power;
  return power * (lead < 1.5 ? 1.0 : lead < 3.0 ? 2.0 : lead < 7.0 ? 5.0 : 10.0);
}

Axis make_axis(double low, double high, bool log) {
  Axis axis;
  axis.log = log;
  if (!(low <= high)) low = log ? 0.1 : 0.0, high = 1.0;
  if (log) {
    axis.low = std::pow(10.0, std::floor(std::log10(low) + 1e-9));
    axis.high = std::pow(10.0, std::ceil(std::log10(high) - 1e-9));
    if (axis.high <= axis.low) axis.high = 10.0 * axis.low;
    const auto decades = static_cast<int>(std::lround(std::log10(axis.high / axis.low)));
    for (int k = 0; k <= decades; ++k) axis.ticks.push_back(axis.low * std::pow(10.0, k));
    return axis;
  }
  if (high - low < 1e-12 * std::max(1.0, std::abs(high))) {
    low -= 0.5;
    high += 0.5;
  }
  const double step = nice_step(high - low);
  axis.low = step * std::floor(low / step + 1e-9);
  axis.high = step * std::ceil(high / step - 1e-9);
  const auto steps = static_cast<int>(std::lround((axis.high - axis.low) / step));
  for (int k = 0; k <= steps; ++k) {
    const double t = axis.low + step * k;
    axis.ticks.push_back(std::abs(t) < 1e-12 * step ? 0.0 : t);
  }
  return axis;
}

Axis axis_of(const Plot& plot, bool is_x) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const Series& s : plot.series)
    for (std::size_t k = 0; k < std::min(s.x.size(), s.y.size()); ++k) {
      if (!drawable(s.x[k], plot.log_x) || !drawable(s.y[k], plot.log_y)) continue;
      const double v = is_x ? s.x[k] : s.y[k];
      low = std::min(low, v);
      high = std::max(high, v);
    }
  return make_axis(low, high, is_x ? plot.log_x : plot.log_y);
}

}  // namespace

std::string escape_xml(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string plot_svg(const Plot& plot) {
  const Axis x = axis_of(plot, true);
  const Axis y = axis_of(plot, false);
  const double inner_w = kWidth - kLeft - kRight;
  const double inner_h = kHeight - kTop - kBottom;
  const auto px = [&](double v) { return kLeft + inner_w * x.fraction(v); };
  const auto py = [&](double v) { return kTop + inner_h * (1.0 - y.fraction(v)); };

  std::string svg = fmt::format(
      R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {0} {1}" width="{0}" height="{1}" font-family="system-ui, sans-serif" font-size="12">)"
      "\n"
      R"(<rect width="{0}" height="{1}" fill="#fff"/>)"
      "\n",
      kWidth, kHeight);
  const std::string title = plot.figure.empty() ? plot.title : plot.figure + ": " + plot.title;
  svg +=
      fmt::format(R"(<text x="{}" y="22" text-anchor="middle" font-size="15" fill="#111">{}</text>)"
                  "\n",
                  0.5 * kWidth, escape_xml(title));
  for (const double t : x.ticks)
    svg += fmt::format(
        R"(<line x1="{0:.1f}" y1="{1:.1f}" x2="{0:.1f}" y2="{2:.1f}" stroke="#e3e6ea"/><text x="{0:.1f}" y="{3:.1f}" text-anchor="middle" fill="#444">{4:g}</text>)"
        "\n",
        px(t), kTop, kTop + inner_h, kTop + inner_h + 17.0, t);
  for (const double t : y.ticks)
    svg += fmt::format(
        R"(<line x1="{0:.1f}" y1="{1:.1f}" x2="{2:.1f}" y2="{1:.1f}" stroke="#e3e6ea"/><text x="{3:.1f}" y="{4:.1f}" text-anchor="end" fill="#444">{5:g}</text>)"
        "\n",
        kLeft, py(t), kLeft + inner_w, kLeft - 7.0, py(t) + 4.0, t);
  svg += fmt::format(R"(<rect x="{}" y="{}" width="{}" height="{}" fill="none" stroke="#666"/>)"
                     "\n",
                     kLeft, kTop, inner_w, inner_h);
  svg += fmt::format(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="middle" fill="#222">{}</text>)"
                     "\n",
                     kLeft + 0.5 * inner_w, kHeight - 14.0, escape_xml(plot.x_label));
  svg += fmt::format(
      R"svg(<text transform="translate(18 {:.1f}) rotate(-90)" text-anchor="middle" fill="#222">{}</text>)svg"
      "\n",
      kTop + 0.5 * inner_h, escape_xml(plot.y_label));

  for (std::size_t s = 0; s < plot.series.size(); ++s) {
    const Series& series = plot.series[s];
    const char* color = kColors[s % kColors.size()];
    std::string points;
    std::string marks;
    const std::size_t count = std::min(series.x.size(), series.y.size());
    const std::size_t stride = 1 + count / kPointsPerLine;
    for (std::size_t k = 0; k < count; ++k) {
      if (k % stride != 0 && k + 1 != count) continue;
      if (!drawable(series.x[k], plot.log_x) || !drawable(series.y[k], plot.log_y)) continue;
      points += fmt::format("{:.1f},{:.1f} ", px(series.x[k]), py(series.y[k]));
      if (series.markers)
        marks += fmt::format(R"(<circle cx="{:.1f}" cy="{:.1f}" r="3.2" fill="{}"/>)",
                             px(series.x[k]), py(series.y[k]), color);
    }
    svg += fmt::format(R"(<polyline points="{}" fill="none" stroke="{}" stroke-width="1.8"{}/>{})"
                       "\n",
                       points, color, series.dashed ? R"( stroke-dasharray="6 4")" : "", marks);
    const double ly = kTop + 14.0 + 17.0 * static_cast<double>(s);
    svg += fmt::format(
        R"(<line x1="{0:.1f}" y1="{1:.1f}" x2="{2:.1f}" y2="{1:.1f}" stroke="{3}" stroke-width="2.5"{4}/><text x="{5:.1f}" y="{6:.1f}" text-anchor="end" fill="#222">{7}</text>)"
        "\n",
        kLeft + inner_w - 32.0, ly, kLeft + inner_w - 8.0, color,
        series.dashed ? R"( stroke-dasharray="6 4")" : "", kLeft + inner_w - 38.0, ly + 4.0,
        escape_xml(series.label));
  }
  return svg + "</svg>\n";
}

SvgDrawing::SvgDrawing(const Vec2& low, const Vec2& high, double width_px)
    : low_(low),
      scale_(width_px / (high.x() - low.x())),
      width_px_(width_px),
      height_px_(scale_ * (high.y() - low.y())) {}

Vec2 SvgDrawing::to_px(const Vec2& p) const {
  return {scale_ * (p.x() - low_.x()), height_px_ - scale_ * (p.y() - low_.y())};
}

void SvgDrawing::line(const Vec2& a, const Vec2& b, std::string_view color, double width_px) {
  const Vec2 p = to_px(a);
  const Vec2 q = to_px(b);
  body_ += fmt::format(
      R"(<line x1="{:.2f}" y1="{:.2f}" x2="{:.2f}" y2="{:.2f}" stroke="{}" stroke-width="{:g}"/>)"
      "\n",
      p.x(), p.y(), q.x(), q.y(), color, width_px);
}

void SvgDrawing::arrow(const Vec2& from, const Vec2& to, std::string_view color, double width_px) {
  line(from, to, color, width_px);
  const Vec2 along = to_px(to) - to_px(from);
  const double length = along.norm();
  if (length < 1e-9) return;
  const Vec2 u = along / length;
  const Vec2 across(-u.y(), u.x());
  const double head = std::min(9.0, 0.5 * length);
  const Vec2 tip = to_px(to);
  const Vec2 left = tip - head * u + 0.45 * head * across;
  const Vec2 right = tip - head * u - 0.45 * head * across;
  body_ += fmt::format(R"(<polygon points="{:.2f},{:.2f} {:.2f},{:.2f} {:.2f},{:.2f}" fill="{}"/>)"
                       "\n",
                       tip.x(), tip.y(), left.x(), left.y(), right.x(), right.y(), color);
}

void SvgDrawing::circle(const Vec2& center, double radius, std::string_view stroke,
                        std::string_view fill, double width_px) {
  const Vec2 c = to_px(center);
  body_ += fmt::format(
      R"(<circle cx="{:.2f}" cy="{:.2f}" r="{:.2f}" stroke="{}" fill="{}" stroke-width="{:g}"/>)"
      "\n",
      c.x(), c.y(), scale_ * radius, stroke, fill, width_px);
}

void SvgDrawing::rectangle(const Vec2& low, const Vec2& high, std::string_view stroke,
                           std::string_view fill, double width_px) {
  polygon({low, {high.x(), low.y()}, high, {low.x(), high.y()}}, stroke, fill, width_px);
}

void SvgDrawing::polygon(const std::vector<Vec2>& points, std::string_view stroke,
                         std::string_view fill, double width_px) {
  std::string list;
  for (const Vec2& point : points) {
    const Vec2 p = to_px(point);
    list += fmt::format("{:.2f},{:.2f} ", p.x(), p.y());
  }
  body_ += fmt::format(R"(<polygon points="{}" stroke="{}" fill="{}" stroke-width="{:g}"/>)"
                       "\n",
                       list, stroke, fill, width_px);
}

void SvgDrawing::text(const Vec2& at, std::string_view text, double size_px,
                      std::string_view anchor, std::string_view color) {
  const Vec2 p = to_px(at);
  body_ += fmt::format(
      R"(<text x="{:.2f}" y="{:.2f}" font-size="{:g}" text-anchor="{}" fill="{}">{}</text>)"
      "\n",
      p.x(), p.y(), size_px, anchor, color, escape_xml(text));
}

std::string SvgDrawing::document() const {
  return fmt::format(
             R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {0:.0f} {1:.0f}" width="{0:.0f}" height="{1:.0f}" font-family="system-ui, sans-serif"><rect width="100%" height="100%" fill="#fff"/>)"
             "\n",
             width_px_, height_px_) +
         body_ + "</svg>\n";
}

}  // namespace gotai::experiments
