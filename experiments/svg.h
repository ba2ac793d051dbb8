/// @file
/// Small SVG documents: line plots and drawings, for reports and papers.
#pragma once

#include <string>
#include <string_view>

#include "experiment.h"
#include "gotai/core/types.h"

namespace gotai::experiments {

/// Draws a plot with axes, ticks, legend and title.
std::string plot_svg(const Plot& plot);

/// Replaces &, <, > and quotes for use in XML and HTML.
std::string escape_xml(std::string_view text);

/// A drawing in user coordinates: x to the right, y up.
class SvgDrawing {
 public:
  /// @param low, high  corners of the visible region, in user units
  /// @param width_px   width of the picture; its height follows
  SvgDrawing(const Vec2& low, const Vec2& high, double width_px);

  void line(const Vec2& a, const Vec2& b, std::string_view color, double width_px = 1.0);
  void arrow(const Vec2& from, const Vec2& to, std::string_view color, double width_px = 1.5);
  void circle(const Vec2& center, double radius, std::string_view stroke, std::string_view fill,
              double width_px = 1.0);
  void rectangle(const Vec2& low, const Vec2& high, std::string_view stroke, std::string_view fill,
                 double width_px = 1.0);
  void polygon(const std::vector<Vec2>& points, std::string_view stroke, std::string_view fill,
               double width_px = 1.0);
  void text(const Vec2& at, std::string_view text, double size_px = 13.0,
            std::string_view anchor = "middle", std::string_view color = "#222");

  /// The whole document.
  std::string document() const;

 private:
  Vec2 to_px(const Vec2& p) const;

  Vec2 low_;
  double scale_;
  double width_px_;
  double height_px_;
  std::string body_;
};

}  // namespace gotai::experiments
