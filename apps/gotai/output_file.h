/// @file
/// Outputs are never overwritten by accident.
#pragma once

#include <string>

namespace gotai::cli {

/// @throws FileError when the file exists (unless forced) or its folder does not
void require_free(const std::string& path, bool force);

}  // namespace gotai::cli
