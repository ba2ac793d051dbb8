/// @file
/// Small scenes that run in well under a second.
#pragma once

namespace gotai::test {

/// Two cubes that fall on a floor and on each other.
inline constexpr const char* kTwoCubes = R"(
[world]
duration = 0.5
[collision]
level = 3
[time]
step = 0.005
[shapes.cube]
generate = "cube"
prepared_level = 4
[[plane]]
[[bodies]]
shape = "cube"
position = [0, 0, 0.8]
[[bodies]]
shape = "cube"
position = [0.2, 0.1, 2.3]
rotation = { axis = [1, 1, 0], degrees = 20 }
)";

/// Hexapods that fall into a container; long enough to be interrupted.
inline constexpr const char* kManyHexapods = R"(
[world]
duration = 2.0
[collision]
level = 4
[time]
step = 0.01
[shapes.block]
generate = "hexapod"
size = 1.0
[[container]]
inner = [3, 3, 3]
[[pour]]
shape = "block"
count = 12
region = { min = [-0.9, -0.9, 0.8], max = [0.9, 0.9, 6] }
seed = 3
)";

}  // namespace gotai::test
