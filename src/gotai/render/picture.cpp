#include "gotai/render/picture.h"

// stb is compiled here only; its functions stay inside this file.
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

#include <algorithm>
#include <memory>

#include "gotai/core/error.h"

namespace gotai::render {

Picture side_by_side(std::span<const Picture> pictures, int gap) {
  if (pictures.empty()) return {};
  const int count = static_cast<int>(pictures.size());
  Picture out(count * pictures[0].width + (count - 1) * gap, pictures[0].height);
  std::ranges::fill(out.rgb, std::uint8_t{255});
  for (int k = 0; k < count; ++k) {
    const Picture& part = pictures[static_cast<std::size_t>(k)];
    const std::size_t row = 3 * static_cast<std::size_t>(part.width);
    for (int y = 0; y < part.height; ++y)
      std::copy_n(part.rgb.data() + static_cast<std::size_t>(y) * row, row,
                  out.pixel(k * (part.width + gap), y));
  }
  return out;
}

void write_png(const std::string& path, const Picture& picture) {
  if (stbi_write_png(path.c_str(), picture.width, picture.height, 3, picture.rgb.data(),
                     3 * picture.width) == 0)
    throw FileError(path, "cannot be written; is there such a folder, and space on the disk?");
}

Picture read_png(const std::string& path) {
  int width = 0;
  int height = 0;
  int channels = 0;
  const std::unique_ptr<stbi_uc, void (*)(void*)> data(
      stbi_load(path.c_str(), &width, &height, &channels, 3), stbi_image_free);
  if (!data) throw FileError(path, "is missing or no PNG picture");
  Picture picture(width, height);
  std::copy_n(data.get(), picture.rgb.size(), picture.rgb.begin());
  return picture;
}

}  // namespace gotai::render
