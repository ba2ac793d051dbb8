#include "runner.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <thread>

#include "gotai/core/error.h"
#include "gotai/core/hash.h"
#include "gotai/core/stopwatch.h"
#include "version.h"

namespace gotai::experiments {
namespace {

namespace fs = std::filesystem;

std::string effort_name(Effort effort) { return effort == Effort::quick ? "quick" : "full"; }

/// Name of the file that keeps a finished point.
fs::path record_path(const fs::path& folder, Effort effort, const Json& point) {
  Hasher hasher;
  hasher.text(kVersion).text(kCommit).text(effort_name(effort)).text(point.dump());
  return folder / "records" / (hasher.digest().hex() + ".json");
}

bool read_record(const fs::path& path, Record& out) {
  std::ifstream in(path);
  if (!in) return false;
  out = Json::parse(in, nullptr, false);
  return !out.is_discarded();
}

/// Written beside and renamed, so that an interrupted run leaves no half record.
void write_record(const fs::path& path, const Record& record) {
  const fs::path partial = path.string() + ".partial";
  std::ofstream(partial) << record.dump() << "\n";
  fs::rename(partial, path);
}

/// Processor time of the whole program [s].
double processor_seconds() {
  return static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC);
}

/// Runs a point and keeps its record, with what it took: "wall_s", and "cpu_s", which has the
/// points beside it in it when several run at once.
Record run_point(const Experiment& experiment, const Json& point, const fs::path& folder,
                 Effort effort) {
  const fs::path path = record_path(folder, effort, point);
  const fs::path files = folder / "points" / path.stem();
  fs::create_directories(files);
  Record record = point;
  try {
    const Stopwatch clock;
    const double processor_start = processor_seconds();
    record.update(experiment.run(point, files.string()));
    record["wall_s"] = clock.seconds();
    record["cpu_s"] = processor_seconds() - processor_start;
  } catch (const std::exception& error) {
    throw Error(
        fmt::format("experiment {}, point {}: {}", experiment.id, point.dump(), error.what()));
  }
  write_record(path, record);
  return record;
}

/// Numbers of the thesis's figures that an outcome shows, in its order.
std::vector<std::string> figures_of(const Outcome& outcome) {
  std::vector<std::string> numbers;
  const auto add = [&](const std::string& figure) {
    if (!figure.empty() && std::find(numbers.begin(), numbers.end(), figure) == numbers.end())
      numbers.push_back(figure);
  };
  for (const Plot& plot : outcome.plots) add(plot.figure);
  for (const Picture& picture : outcome.pictures) add(picture.figure);
  for (const Animation& animation : outcome.animations) add(animation.figure);
  return numbers;
}

std::string cpu_model() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  return "unknown";
}

}  // namespace

bool Result::passed() const {
  for (const Verdict& verdict : outcome.verdicts)
    if (!verdict.passed) return false;
  return true;
}

Json provenance() {
  const auto now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  Json j;
  j["version"] = kVersion;
  j["commit"] = kCommit;
  j["date"] = fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(now));
  j["processor"] = cpu_model();
  j["processors"] = std::thread::hardware_concurrency();
  j["compiler"] = __VERSION__;
  return j;
}

Result run_experiment(const Experiment& experiment, const RunOptions& options) {
  const fs::path folder = fs::path(options.folder) / experiment.id;
  fs::create_directories(folder / "records");
  const std::vector<Json> points = experiment.sweep(options.effort);
  Result result;
  result.experiment = &experiment;
  result.effort = options.effort;
  result.records.resize(points.size());

  std::vector<std::size_t> open;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const fs::path kept = record_path(folder, options.effort, points[k]);
    if (options.fresh || !read_record(kept, result.records[k])) open.push_back(k);
  }

  Stopwatch clock;
  std::atomic<std::size_t> next{0};
  std::size_t done = points.size() - open.size();
  std::mutex mutex;
  std::exception_ptr failure;
  const auto work = [&] {
    for (std::size_t k = next++; k < open.size(); k = next++) {
      const Json& point = points[open[k]];
      {
        const std::lock_guard lock(mutex);
        if (failure) return;
        if (options.progress) options.progress(done, points.size(), point);
      }
      try {
        result.records[open[k]] = run_point(experiment, point, folder, options.effort);
      } catch (...) {
        const std::lock_guard lock(mutex);
        failure = std::current_exception();
        return;
      }
      const std::lock_guard lock(mutex);
      ++done;
    }
  };
  std::vector<std::thread> workers;
  const int threads = experiment.timed ? 1 : std::max(1, options.threads);
  for (int t = 1; t < threads; ++t) workers.emplace_back(work);
  work();
  for (std::thread& worker : workers) worker.join();
  if (failure) std::rethrow_exception(failure);

  result.wall_s = clock.seconds();
  result.outcome = experiment.conclude(result.records, options.effort);
  result.provenance = provenance();
  for (const char* seconds : {"wall_s", "cpu_s"}) {
    double sum = 0.0;
    for (const Record& record : result.records) sum += record.value(seconds, 0.0);
    result.provenance[seconds] = sum;
  }
  return result;
}

Json to_json(const Result& result) {
  Json j;
  j["experiment"] = result.experiment->id;
  j["thesis"] = result.experiment->thesis;
  j["title"] = result.experiment->title;
  j["effort"] = effort_name(result.effort);
  j["passed"] = result.passed();
  j["results"] = Json::array();
  for (Record record : result.records) {
    record.erase("curves");
    j["results"].push_back(std::move(record));
  }
  j["figures"] = Json::array();
  for (const std::string& figure : figures_of(result.outcome)) j["figures"].push_back(figure);
  j["tables"] = Json::array();
  for (const Table& table : result.outcome.tables)
    if (!table.number.empty()) j["tables"].push_back(table.number);
  j["verdicts"] = Json::array();
  for (const Verdict& v : result.outcome.verdicts)
    j["verdicts"].push_back(
        {{"what", v.what}, {"expected", v.expected}, {"found", v.found}, {"passed", v.passed}});
  j["provenance"] = result.provenance;
  return j;
}

std::string to_csv(const Result& result) {
  std::vector<std::string> columns;
  for (const Record& record : result.records)
    for (const auto& [key, value] : record.items())
      if (key != "curves" && std::find(columns.begin(), columns.end(), key) == columns.end())
        columns.push_back(key);
  std::string text;
  for (const std::string& column : columns) text += (text.empty() ? "" : ",") + column;
  text += "\n";
  for (const Record& record : result.records) {
    for (std::size_t k = 0; k < columns.size(); ++k) {
      if (k > 0) text += ",";
      if (!record.contains(columns[k])) continue;
      const Json& value = record[columns[k]];
      text += value.is_string() ? value.get<std::string>() : value.dump();
    }
    text += "\n";
  }
  return text;
}

}  // namespace gotai::experiments
