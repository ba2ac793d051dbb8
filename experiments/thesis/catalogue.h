/// @file
/// The experiments, one function and one file each, in the order of the thesis.
#pragma once

#include "experiment.h"

namespace gotai::experiments {

Experiment fall();       ///< Figs. 4-4..4-6
Experiment superpose();  ///< Fig. 4-7
Experiment throw_();     ///< Figs. 6-1..6-3

}  // namespace gotai::experiments
