/// @file
/// The viewer's page, which is built from viewer/ and lies inside the program.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace gotai::view {

/// The page as it was built, without a run; empty when the program was built without node and npm.
std::string_view page_template();

/// A page that shows the run in a container (ContainerWriter), complete in itself.
/// @throws Error when the program holds no page, saying how to get one
std::string recorded_page(std::span<const std::uint8_t> container);

/// A page that follows the simulation of the server it came from.
/// @throws Error when the program holds no page, saying how to get one
std::string live_page();

}  // namespace gotai::view
