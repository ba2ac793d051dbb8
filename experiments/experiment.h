/// @file
/// Experiments as data: what is swept, how a point is run, what must come out, how it is drawn.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace gotai::experiments {

/// Keys keep their order, so that tables and files read like the definition.
using Json = nlohmann::ordered_json;

/// How much is run: `quick` fits into continuous integration, `full` is what the documentation
/// quotes.
enum class Effort { quick, full };

/// One point of a sweep and what was measured there: parameters and metrics in one flat object,
/// as `gotai experiment --json` prints it (`{"method": "C", "model": "spheres", "level": 3, "rms":
/// ..}`). Arrays under "curves" hold what plots need and are left out of tables.
using Record = Json;

/// One number that must come out, and whether it did.
struct Verdict {
  std::string what;      ///< "RMS of C at level 3"
  std::string expected;  ///< "0.0730 within 3 %"
  std::string found;     ///< "0.0731"
  bool passed = false;
};

/// A line of a plot.
struct Series {
  std::string label;
  std::vector<double> x;
  std::vector<double> y;
  bool markers = true;  ///< a mark at every point
  bool dashed = false;  ///< references are dashed
};

/// A plot with its number in the thesis.
struct Plot {
  std::string figure;  ///< "Fig. 4-5", or "" for our own
  std::string title;
  std::string x_label;
  std::string y_label;
  bool log_x = false;
  bool log_y = false;
  std::vector<Series> series;
};

/// A picture made from live data with its number in the thesis.
struct Picture {
  std::string figure;
  std::string title;
  std::string svg;  ///< an SVG document, or
  std::string png;  ///< a PNG, base64
};

/// A table with its number in the thesis; the first row is the head.
struct Table {
  std::string number;  ///< "Table 6-1", or ""
  std::string title;
  std::vector<std::vector<std::string>> rows;
};

/// A run to play back in the report, and a strip of pictures of it.
struct Animation {
  std::string figure;
  std::string title;
  std::string strip;  ///< PNG, base64
  std::string run;    ///< the viewer's data, deflated, base64; "" without the viewer
};

/// What an experiment shows once its records are there.
struct Outcome {
  std::vector<Verdict> verdicts;
  std::vector<Plot> plots;
  std::vector<Picture> pictures;
  std::vector<Table> tables;
  std::vector<Animation> animations;
};

/// One experiment [spec: the thesis's figures and tables as runnable definitions].
struct Experiment {
  std::string id;      ///< "fall"
  std::string thesis;  ///< "Figs. 4-4..4-6"
  std::string title;   ///< one line
  std::string about;   ///< what is done and what the thesis claims; a paragraph
  /// Times are measured: points run one after the other, on an otherwise idle program.
  bool timed = false;
  /// The points of the sweep, as parameters.
  std::function<std::vector<Json>(Effort)> sweep;
  /// Runs one point: its parameters in, metrics out (merged into the record by the runner).
  /// @param folder  for files that belong to the point (recordings); exists
  std::function<Json(const Json& point, const std::string& folder)> run;
  /// Judges and draws.
  std::function<Outcome(const std::vector<Record>&, Effort)> conclude;
};

/// All experiments in the order of the thesis, ours last.
const std::vector<Experiment>& all_experiments();

/// @throws InvalidArgument listing the names that exist
const Experiment& find_experiment(const std::string& id);

/// A verdict on a number. @param relative  tolerance as a fraction of the expected value
Verdict within(std::string what, double found, double expected, double relative);
Verdict at_most(std::string what, double found, double limit);
Verdict at_least(std::string what, double found, double limit);
Verdict holds(std::string what, bool passed, std::string found);

/// The records whose values equal all of those in `match`, in order.
std::vector<Record> select(const std::vector<Record>& records, const Json& match);
/// The one record that matches. @throws Error when there is none
const Record& pick(const std::vector<Record>& records, const Json& match);

}  // namespace gotai::experiments
