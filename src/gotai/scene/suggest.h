/// @file
/// Finds what somebody meant who misspelt a name.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace gotai::scene {

/// The name with the smallest edit distance (insert, delete, replace, swap neighbours), or "" when
/// none is near enough to be a slip. Ties go to the first.
std::string_view nearest_name(std::string_view text, const std::vector<std::string>& names);

/// `; did you mean "friction"? Allowed: restitution, friction, density`
std::string suggestion(std::string_view text, const std::vector<std::string>& names);

}  // namespace gotai::scene
