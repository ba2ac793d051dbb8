#include "gotai/view/container.h"

#include <bit>

namespace gotai::view {

// The page reads typed arrays in the order of the machine, which is little endian everywhere a
// browser runs; so must be the machine that writes.
static_assert(std::endian::native == std::endian::little);

std::vector<std::uint8_t> ContainerWriter::finish(nlohmann::json header) const {
  header["arrays"] = arrays_;
  // Names in a scene may hold any bytes: those that are not UTF-8 are shown as such.
  const std::string text = header.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  const auto length = static_cast<std::uint32_t>(text.size());
  const std::size_t start = (8 + text.size() + 7) / 8 * 8;
  std::vector<std::uint8_t> bytes(start + data_.size());
  std::memcpy(bytes.data(), "GTV1", 4);
  std::memcpy(bytes.data() + 4, &length, 4);
  std::memcpy(bytes.data() + 8, text.data(), text.size());
  if (!data_.empty()) std::memcpy(bytes.data() + start, data_.data(), data_.size());
  return bytes;
}

}  // namespace gotai::view
