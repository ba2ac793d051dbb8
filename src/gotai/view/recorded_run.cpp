#include "gotai/view/recorded_run.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "gotai/recording/recording_reader.h"

namespace gotai::view {
namespace {

using nlohmann::json;
using recording::RecordingReader;

std::string title_of(const RecordingReader& reader) {
  const std::string& scene = reader.scene_path();
  return std::filesystem::path(scene.empty() ? reader.path() : scene).stem().string();
}

/// Settings and totals as facts; what an older or newer program wrote differently is left out.
void add_facts(const RecordingReader& reader, RunView& run) {
  const json settings = json::parse(reader.settings_json(), nullptr, false);
  const auto text = [](const json& value) {
    if (value.is_number_float()) return fmt::format("{:.6g}", value.get<double>());
    return value.is_string() ? value.get<std::string>() : value.dump();
  };
  if (settings.is_object()) {
    for (const auto& [section, values] : settings.items())
      if (values.is_object())
        for (const auto& [key, value] : values.items())
          run.facts.emplace_back(fmt::format("{}.{}", section, key), text(value));
    if (settings.contains("gravity")) run.facts.emplace_back("gravity", text(settings["gravity"]));
    const json level = settings.value(json::json_pointer("/collision/level"), json());
    run.level = level.is_number_integer() ? level.get<int>() : 0;
    const json gravity = settings.value("gravity", json::array());
    if (gravity.size() == 3)
      for (std::size_t k = 0; k < 3; ++k)
        run.gravity[static_cast<int>(k)] = gravity[k].is_number() ? gravity[k].get<double>() : 0.0;
  }
  run.facts.emplace_back("frames",
                         fmt::format("{} at {:g} per second", reader.frame_count(), reader.fps()));
  const json totals = json::parse(reader.certificate(), nullptr, false);
  if (!totals.is_object()) {
    run.facts.emplace_back("ended", "no: the run was interrupted or goes on");
    return;
  }
  for (const auto& [key, value] : totals.items())
    run.facts.emplace_back(
        key, value.is_number_float() ? fmt::format("{:.4g}", value.get<double>()) : text(value));
}

std::vector<model::StepReport> read_steps(const RecordingReader& reader) {
  const recording::StepTable table = reader.steps();
  std::vector<model::StepReport> steps(table.time.size());
  for (std::size_t i = 0; i < steps.size(); ++i) {
    model::StepReport& step = steps[i];
    step.step = i + 1;
    step.time = table.time[i];
    step.dt = table.dt[i];
    step.pairs = table.pairs[i];
    step.contacts = table.contacts[i];
    step.max_overlap = table.overlap[i].x();
    step.mean_overlap = table.overlap[i].y();
    step.energy = {table.energy[i].x(), table.energy[i].y(), table.energy[i].z()};
    step.solve.residual = table.residual[i];
    step.collision_s = 1e-3 * static_cast<double>(table.ms[i][0]);
    step.impulse_s = 1e-3 * static_cast<double>(table.ms[i][1]);
    step.integration_s = 1e-3 * static_cast<double>(table.ms[i][2]);
    step.other_s = 1e-3 * static_cast<double>(table.ms[i][3]);
  }
  return steps;
}

FrameView read_frame(const RecordingReader& reader, std::size_t number) {
  const recording::Frame frame = reader.frame(number);
  FrameView view;
  view.time = frame.time;
  view.v_W = frame.v_W;
  view.w_W = frame.w_W;
  for (std::size_t i = 0; i < frame.poses.size(); ++i) {
    view.x_W.push_back(frame.poses[i] * reader.bodies()[i].center_of_mass);
    view.q_WB.push_back(frame.poses[i].q);
  }
  for (const recording::RecordedContact& contact : reader.contacts(number)) {
    view.contacts.body.insert(view.contacts.body.end(), {contact.body_a, contact.body_b});
    view.contacts.point_W.push_back(contact.point_W);
    view.contacts.normal_W.push_back(contact.normal_W);
    view.contacts.impulse_W.push_back(contact.impulse_W);
    view.contacts.gap.push_back(contact.gap);
  }
  return view;
}

}  // namespace

RecordedRun open_recorded_run(const std::string& path) {
  const auto reader = std::make_shared<const RecordingReader>(path);
  RecordedRun out;
  out.run.title = title_of(*reader);
  out.run.materials = reader->materials();
  add_facts(*reader, out.run);
  for (const recording::RecordedShape& shape : reader->shapes())
    out.run.shapes.push_back({shape.name, std::make_shared<const geometry::Mesh>(shape.mesh),
                              shape.center_of_mass, shape.grid, shape.voxels});
  for (const recording::RecordedBody& body : reader->bodies())
    out.run.bodies.push_back({body.name, body.kind, body.geometry, body.shape, body.material,
                              body.mass, body.bounding_radius, body.half_extent});
  out.frames.times = reader->frame_times();
  out.frames.read = [reader](std::size_t frame) { return read_frame(*reader, frame); };
  out.steps = read_steps(*reader);
  return out;
}

}  // namespace gotai::view
