/// @file
/// The experiments, one function and one file each, in the order of the thesis.
#pragma once

#include "experiment.h"

namespace gotai::experiments {

Experiment fall();          ///< Figs. 4-4..4-6
Experiment superpose();     ///< Fig. 4-7
Experiment throw_();        ///< Figs. 6-1..6-3
Experiment drop_time();     ///< Figs. 6-4, 6-5, Tables 6-1, 6-2
Experiment slide();         ///< Figs. 6-6..6-8, Tables 6-3, 6-4
Experiment pile_time();     ///< Figs. 6-9, 6-10, Table 6-5
Experiment pile_error();    ///< Figs. 6-11..6-16, Tables 6-6, 6-8
Experiment rocks_error();   ///< Figs. 6-17..6-25, Tables 6-6, 6-7, 6-9, 6-10
Experiment polygons();      ///< Figs. 6-26, 6-27
Experiment parallel();      ///< Figs. 6-28, 6-29
Experiment figures();       ///< Figs. 2-1..5-6
Experiment animations();    ///< Figs. 6-2, 6-5, 6-7, 6-10, 6-18, 6-27, 6-28, 6-29
Experiment cube_on_cube();  ///< ours
Experiment stack();         ///< ours
Experiment spin();          ///< Fig. 5-5
Experiment top();           ///< ours
Experiment tunnel();        ///< Fig. 4-10

}  // namespace gotai::experiments
