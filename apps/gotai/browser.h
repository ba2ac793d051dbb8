/// @file
/// The desktop's browser.
#pragma once

#include <string>

namespace gotai::cli {

/// Hands a file or an address to the desktop's program for it, and does not wait. Says what to open
/// by hand when there is no such program.
void open_in_browser(const std::string& target);

}  // namespace gotai::cli
