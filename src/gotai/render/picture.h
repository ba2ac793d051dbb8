/// @file
/// Pictures in memory and as PNG files.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace gotai::render {

/// 8-bit sRGB, three bytes per pixel, rows from the top.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;

  Picture() = default;
  Picture(int width_px, int height_px)
      : width(width_px),
        height(height_px),
        rgb(3 * static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px)) {}
  std::uint8_t* pixel(int x, int y) {
    return rgb.data() + 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                             static_cast<std::size_t>(x));
  }
};

/// Pictures of the same size side by side, with a white gap [pixels] between them.
Picture side_by_side(std::span<const Picture> pictures, int gap);

/// @throws FileError when the file cannot be written
void write_png(const std::string& path, const Picture& picture);
/// @throws FileError when the file is missing or no picture
Picture read_png(const std::string& path);

}  // namespace gotai::render
