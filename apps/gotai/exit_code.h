/// @file
/// Exit codes of the program, listed in docs/command-line.md and at the end of `gotai --help`.
#pragma once

namespace gotai::cli {

enum ExitCode : int {
  kSuccess = 0,
  kInputError = 1,         ///< a file or value is wrong, or a file cannot be written
  kUsageError = 2,         ///< the command line itself is wrong
  kSimulationFailed = 3,   ///< the state stopped being finite; recorded frames are kept
  kExpectationMissed = 4,  ///< an experiment's number did not come out as expected
  kInterrupted = 130,      ///< Ctrl-C: the frame was finished and the recording closed
};

}  // namespace gotai::cli
