#include <fmt/format.h>

#include <filesystem>

#include "commands.h"
#include "console.h"
#include "exit_code.h"
#include "report.h"
#include "runner.h"

namespace gotai::cli {
namespace {

constexpr const char* kExperimentFooter = R"(Examples:
  gotai experiment list                    what there is
  gotai experiment fall                    Figs. 4-4 to 4-6: numbers, plots, report
  gotai experiment fall --json             the same numbers for programs
  gotai experiment all --full -o results   everything as the documentation quotes it (hours)
Finished points are kept in the output folder, so an interrupted run goes on where it stopped.
Exit code 4: some number did not come out as expected.)";

struct Options {
  std::string name;
  std::string folder = "experiment-results";
  bool quick = false;
  bool full = false;
  bool json = false;
  bool fresh = false;
  int threads = 1;
};

int list_experiments() {
  for (const experiments::Experiment& e : experiments::all_experiments())
    print(fmt::format("{:14} {:42} {}\n", e.id, e.thesis, e.title));
  return kSuccess;
}

experiments::Result run_one(const experiments::Experiment& experiment, const Options& options) {
  ProgressLine progress;
  experiments::RunOptions how;
  how.effort = options.full ? experiments::Effort::full : experiments::Effort::quick;
  how.folder = options.folder;
  how.threads = options.threads;
  how.fresh = options.fresh;
  how.progress = [&](std::size_t done, std::size_t all, const experiments::Json& point) {
    progress.show(fmt::format("{}: {} of {}  {}", experiment.id, done, all, point.dump()));
  };
  return experiments::run_experiment(experiment, how);
}

void print_verdicts(const experiments::Result& result) {
  print(fmt::format("{}: {} ({} points, {})\n", result.experiment->id, result.experiment->title,
                    result.records.size(), format_duration(result.wall_s)));
  for (const experiments::Verdict& v : result.outcome.verdicts)
    print(fmt::format("  {}  {}: expected {}, found {}\n", v.passed ? "ok    " : "FAILED", v.what,
                      v.expected, v.found));
}

int run_experiments(const Options& options) {
  std::vector<const experiments::Experiment*> chosen;
  if (options.name == "all") {
    for (const experiments::Experiment& e : experiments::all_experiments()) chosen.push_back(&e);
  } else {
    chosen.push_back(&experiments::find_experiment(options.name));
  }
  std::vector<experiments::Result> results;
  experiments::Json json = experiments::Json::array();
  bool passed = true;
  for (const experiments::Experiment* experiment : chosen) {
    results.push_back(run_one(*experiment, options));
    const experiments::Result& result = results.back();
    experiments::write_results(result, options.folder + "/" + experiment->id);
    passed = passed && result.passed();
    if (options.json)
      json.push_back(experiments::to_json(result));
    else
      print_verdicts(result);
  }
  if (results.size() > 1)
    experiments::write_text(options.folder + "/report.html", experiments::report_html(results));
  const std::string report = results.size() > 1
                                 ? options.folder + "/report.html"
                                 : options.folder + "/" + chosen[0]->id + "/report.html";
  if (options.json)
    print((results.size() == 1 ? json[0] : json).dump(2) + "\n");
  else
    print(fmt::format("Report: {}\n", report));
  return passed ? kSuccess : kExpectationMissed;
}

}  // namespace

void add_experiment_command(CLI::App& app, Action& action) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "experiment", "Reproduce a figure or table of the thesis and check what comes out");
  command->add_option("name", options->name, "an experiment, or: list, all")->required();
  CLI::Option* quick =
      command->add_flag("--quick", options->quick, "small sweeps, minutes in all (default)");
  command->add_flag("--full", options->full, "the whole sweeps")->excludes(quick);
  command->add_option("-o,--output", options->folder, "folder for records, plots and reports")
      ->capture_default_str();
  command->add_flag("--json", options->json, "print the results as JSON");
  command->add_flag("--fresh", options->fresh, "compute every point anew");
  command->add_option("--threads", options->threads, "points at once, where no time is measured")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->footer(kExperimentFooter);
  command->callback([options, &action] {
    action = [options] {
      return options->name == "list" ? list_experiments() : run_experiments(*options);
    };
  });
}

}  // namespace gotai::cli
