/// @file
/// A run's summary for machines and for people.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "gotai/world/run_summary.h"

namespace gotai::cli {

/// The object of `gotai run --json`; docs/command-line.md lists its fields.
nlohmann::ordered_json to_json(const RunSummary& summary);
/// The table of `gotai run`.
std::string to_table(const RunSummary& summary);

}  // namespace gotai::cli
