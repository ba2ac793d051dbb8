/// @file
/// Recordings described for machines and for people.
#pragma once

#include <nlohmann/json.hpp>

#include "console.h"
#include "gotai/recording/recording_reader.h"

namespace gotai::cli {

nlohmann::ordered_json to_json(const recording::RecordingReader& run);
void describe(const recording::RecordingReader& run, Report& report);

}  // namespace gotai::cli
