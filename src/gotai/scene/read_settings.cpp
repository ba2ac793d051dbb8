#include <fmt/format.h>

#include "gotai/scene/readers.h"
#include "gotai/voxel/pyramid.h"

namespace gotai::scene::detail {
namespace {

const Node kEmpty{{}, Node::Table{}};

/// Reads [name] with `read` when it is there; an absent table leaves the defaults.
template <typename Read>
void read_table(TableReader& document, std::string_view name, const Read& read) {
  const Node* node = document.find(name);
  TableReader table(node == nullptr ? kEmpty : *node, fmt::format("[{}]", name));
  read(table);
  table.finish();
}

void read_world(TableReader& table, SceneDescription& scene) {
  scene.settings.gravity = table.vector("gravity", scene.settings.gravity);
  scene.duration = table.number("duration", scene.duration, range::positive);
  scene.allow_initial_overlap = table.boolean("allow_initial_overlap", false);
}

void read_collision(TableReader& table, model::CollisionSettings& collision) {
  collision.model = read_choice(table, "model", collision.model, model::parse_collision_model);
  collision.level = static_cast<int>(table.integer("level", collision.level, 1, voxel::kMaxLevel));
}

void read_impulse(TableReader& table, model::ImpulseSettings& impulse) {
  impulse.method = read_choice(table, "method", impulse.method, model::parse_impulse_method);
  impulse.contacts =
      read_choice(table, "contacts", impulse.contacts, model::parse_contact_treatment);
  impulse.solver = read_choice(table, "solver", impulse.solver, model::parse_solver);
  impulse.ridge = table.number("ridge", impulse.ridge, range::non_negative);
  impulse.tolerance = table.number("tolerance", impulse.tolerance, range::positive);
  impulse.max_iterations =
      static_cast<int>(table.integer("max_iterations", impulse.max_iterations, 1, 1'000'000));
  constexpr Range penetrations{model::kLeastPenetration, model::kLargestPenetration,
                               "must be from 1e-6 to 0.5 (of the smallest bounding radius)"};
  impulse.penetration = table.number("penetration", impulse.penetration, penetrations);
  impulse.tension = table.boolean("tension", impulse.tension);
  constexpr Range resistances{0.0, 1.0, "must be from 0 to 1 (of the smaller bounding radius)"};
  impulse.rolling_resistance =
      table.number("rolling_resistance", impulse.rolling_resistance, resistances);
}

void read_time(TableReader& table, model::TimeSettings& time) {
  if (const Node* step = table.find("step")) {
    if (const auto* text = std::get_if<std::string>(&step->value)) {
      if (*text != "auto") {
        fail(step->where,
             fmt::format("step = \"{}\" must be \"auto\" or seconds, for example 0.01", *text));
      }
      time.step = 0.0;
    } else {
      time.step = read_number(*step, "step", range::positive);
    }
  }
  time.safety = table.number("safety", time.safety, range::positive);
  time.max_step = table.number("max_step", time.max_step, range::positive);
  time.integrator = read_choice(table, "integrator", time.integrator, model::parse_integrator);
}

void read_record(TableReader& table, RecordSettings& record) {
  record.fps = table.number("fps", record.fps, range::positive);
  record.contacts = table.boolean("contacts", record.contacts);
  record.checkpoint = table.number("checkpoint", record.checkpoint, range::non_negative);
}

}  // namespace

void read_settings(TableReader& document, SceneDescription& scene) {
  read_table(document, "world", [&](TableReader& table) { read_world(table, scene); });
  read_table(document, "collision",
             [&](TableReader& table) { read_collision(table, scene.settings.collision); });
  read_table(document, "impulse",
             [&](TableReader& table) { read_impulse(table, scene.settings.impulse); });
  read_table(document, "time", [&](TableReader& table) { read_time(table, scene.settings.time); });
  read_table(document, "record", [&](TableReader& table) { read_record(table, scene.record); });
}

}  // namespace gotai::scene::detail
