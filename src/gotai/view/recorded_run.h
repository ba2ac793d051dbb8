/// @file
/// A recording opened for looking at it.
#pragma once

#include <string>
#include <vector>

#include "gotai/view/pack_run.h"
#include "gotai/view/run_view.h"

namespace gotai::view {

struct RecordedRun {
  RunView run;
  FrameSource frames;  ///< keeps the recording open
  std::vector<model::StepReport> steps;
};

/// @throws FileError when the recording cannot be read
RecordedRun open_recorded_run(const std::string& path);

}  // namespace gotai::view
