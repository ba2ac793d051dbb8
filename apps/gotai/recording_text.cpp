#include "recording_text.h"

#include <fmt/format.h>

#include <algorithm>

namespace gotai::cli {
namespace {

std::uint64_t count_kind(const recording::RecordingReader& run, model::BodyKind kind) {
  return static_cast<std::uint64_t>(
      std::count_if(run.bodies().begin(), run.bodies().end(), [kind](const auto& body) {
        return body.geometry == model::Geometry::shape && body.kind == kind;
      }));
}

// The certificate's numbers, one row each: "energy.max_gain  1.2e-10".
void describe_certificate(const std::string& text, Report& report) {
  const nlohmann::json flat = nlohmann::json::parse(text).flatten();
  for (const auto& [pointer, value] : flat.items()) {
    std::string name = pointer.substr(1);
    std::replace(name.begin(), name.end(), '/', '.');
    report.row(name, value.is_number_float() ? fmt::format("{:.6g}", value.get<double>())
                     : value.is_string()     ? value.get<std::string>()
                                             : value.dump());
  }
}

}  // namespace

nlohmann::ordered_json to_json(const recording::RecordingReader& run) {
  nlohmann::ordered_json json = {
      {"kind", "recording"},
      {"scene", run.scene_path()},
      {"overrides", run.overrides()},
      {"complete", !run.certificate().empty()},
      {"resumable", run.has_checkpoint()},
      {"dynamic", count_kind(run, model::BodyKind::dynamic)},
      {"fixed", count_kind(run, model::BodyKind::fixed)},
      {"kinematic", count_kind(run, model::BodyKind::kinematic)},
      {"shapes", nlohmann::ordered_json::array()},
      {"frames", run.frame_count()},
      {"fps", run.fps()},
      {"duration_s", run.frame_times().empty() ? 0.0 : run.frame_times().back()},
      {"steps", run.steps().time.size()},
      {"settings", nlohmann::ordered_json::parse(run.settings_json())},
      {"certificate", nullptr},
  };
  for (const recording::RecordedShape& shape : run.shapes()) json["shapes"].push_back(shape.name);
  if (!run.certificate().empty()) {
    json["certificate"] = nlohmann::ordered_json::parse(run.certificate());
  }
  return json;
}

void describe(const recording::RecordingReader& run, Report& report) {
  report.row("scene", run.scene_path());
  for (const std::string& assignment : run.overrides()) report.row("--set", assignment);
  report.row("bodies",
             fmt::format("{} dynamic, {} fixed, {} kinematic, of {} shapes",
                         count_kind(run, model::BodyKind::dynamic),
                         count_kind(run, model::BodyKind::fixed),
                         count_kind(run, model::BodyKind::kinematic), run.shapes().size()));
  const double duration = run.frame_times().empty() ? 0.0 : run.frame_times().back();
  report.row("frames", fmt::format("{} over {:.4g} s, {:.4g} per second",
                                   format_count(run.frame_count()), duration, run.fps()));
  report.row("steps", format_count(run.steps().time.size()));
  report.row("settings", run.settings_json());
  if (run.certificate().empty()) {
    report.row("complete", run.has_checkpoint()
                               ? "no: the run was ended from outside; its last checkpoint is kept"
                               : "no: the run was ended from outside");
    return;
  }
  report.heading("the run");
  describe_certificate(run.certificate(), report);
}

}  // namespace gotai::cli
