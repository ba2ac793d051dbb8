#include "gotai/view/page.h"

#include "gotai/core/error.h"
#include "gotai/view/pack.h"

namespace gotai::view {
namespace {

// Where viewer/index.html says what it shows.
constexpr std::string_view kPlace = R"(data-source="file">@GOTAI_RUN@)";

std::string fill(std::string_view source, std::string_view content) {
  const std::string_view page = page_template();
  const std::size_t at = page.find(kPlace);
  if (at == std::string_view::npos)
    throw Error(
        "this program was built without the viewer: node or npm was missing. Install nodejs and "
        "npm, configure with -DGOTAI_BUILD_VIEWER=ON and build again");
  std::string out;
  out.reserve(page.size() + content.size());
  out.append(page.substr(0, at));
  out.append("data-source=\"").append(source).append("\">").append(content);
  out.append(page.substr(at + kPlace.size()));
  return out;
}

}  // namespace

std::string recorded_page(std::span<const std::uint8_t> container) {
  return fill("file", to_base64(deflate(container)));
}

std::string live_page() { return fill("live", ""); }

}  // namespace gotai::view
