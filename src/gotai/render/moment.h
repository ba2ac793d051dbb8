/// @file
/// A run at any time, between its recorded frames too.
#pragma once

#include <vector>

#include "gotai/render/stage.h"
#include "gotai/view/pack_run.h"

namespace gotai::render {

/// Positions between two recorded frames linearly, orientations along the great arc; velocities and
/// contacts are those of the nearer frame. Before the first and after the last frame it holds.
/// @throws InvalidArgument when the run has no frame
view::FrameView moment_at(const view::FrameSource& frames, double time);

/// Measures a run at up to `count` moments, evenly spread over its frames.
Extent measure(const view::RunView& run, const view::FrameSource& frames, std::size_t count);

}  // namespace gotai::render
