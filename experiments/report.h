/// @file
/// Reports: what was expected, what came out, plots and tables, as one self-contained HTML file.
#pragma once

#include <string>
#include <vector>

#include "runner.h"

namespace gotai::experiments {

/// One page for one or more results: figures by their numbers, tables, animations in the viewer,
/// verdicts, provenance. No links to other files: it opens anywhere.
std::string report_html(const std::vector<Result>& results);

/// Writes what a run leaves in its folder: results.json, results.csv, report.html and one SVG per
/// plot and picture ("plot-1.svg", ..).
/// @throws FileError when a file cannot be written
void write_results(const Result& result, const std::string& folder);

/// @throws FileError when the file cannot be written
void write_text(const std::string& path, const std::string& text);

}  // namespace gotai::experiments
