/// @file
/// Runs experiments: sweeps with progress, keeps every finished point, judges, reports.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiment.h"

namespace gotai::experiments {

/// How to run.
struct RunOptions {
  Effort effort = Effort::quick;
  std::string folder;  ///< where records, plots and reports go; one folder per experiment inside
  int threads = 1;     ///< points at once; 1 for timed experiments whatever is said here
  bool fresh = false;  ///< do not use points that an earlier run finished
  /// Called with points done, points in all, and the point that starts.
  std::function<void(std::size_t, std::size_t, const Json&)> progress;
};

/// An experiment that was run.
// clang-tidy 14 suspects the library of JSON of throwing when moved.
// NOLINTNEXTLINE(bugprone-exception-escape)
struct Result {
  const Experiment* experiment = nullptr;
  Effort effort = Effort::quick;
  std::vector<Record> records;
  Outcome outcome;
  Json provenance;      ///< machine, version, commit, settings, date
  double wall_s = 0.0;  ///< of the points that this run computed [s]

  bool passed() const;
};

/// Runs what an earlier run of the same version has not finished, then judges. A finished point is
/// kept as one JSON file keyed by version, effort and parameters.
/// @throws Error with the point when one fails
Result run_experiment(const Experiment& experiment, const RunOptions& options);

/// The machine-readable result: `{"experiment", "effort", "passed", "results": [..], "verdicts":
/// [..], "provenance"}`, curves left out.
Json to_json(const Result& result);
/// The same records as a table with one line per point.
std::string to_csv(const Result& result);

/// Machine, version, commit and date of this run.
Json provenance();

}  // namespace gotai::experiments
