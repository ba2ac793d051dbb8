#include "gotai/recording/recorder.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>

#include "gotai/core/error.h"
#include "gotai/recording/checkpoint.h"
#include "gotai/recording/float_vectors.h"
#include "gotai/recording/hdf5_file.h"
#include "gotai/recording/layout.h"

namespace gotai::recording {
namespace {

constexpr double kTimeSlack = 1e-9;  // frames: 0.01 + 0.01 + .. misses multiples by round-off
// Numbers kept before a flush: a few MB, so that little is lost when a disk fills up.
constexpr std::size_t kMostPending = std::size_t{1} << 19;

/// Rows that are not in the file yet.
struct Pending {
  std::vector<double> frame_t, pose, velocity;
  std::vector<std::uint64_t> frame_step, contact_offset;
  std::vector<std::string> hash;
  std::vector<std::uint32_t> contact_pair;
  std::vector<float> contact_point, contact_normal, contact_gap, contact_impulse;
  std::vector<double> step_t, step_dt, step_energy, step_residual, step_overlap;
  std::vector<std::uint32_t> step_contacts, step_pairs;
  std::vector<float> step_ms;

  std::size_t size() const { return pose.size() + velocity.size() + 12 * contact_gap.size(); }
};

/// The first frame number after a time.
std::uint64_t frame_after(double time, double fps) {
  return static_cast<std::uint64_t>(std::floor(time * fps + kTimeSlack)) + 1;
}

std::vector<std::uint32_t> ids_of(const World& world) {
  std::vector<std::uint32_t> ids;
  for (model::BodyIndex i = 0; i < world.bodies().size(); ++i) ids.push_back(world.id(i).value);
  return ids;
}

}  // namespace

struct Recorder::State {
  State(Hdf5File opened, const RecorderOptions& chosen)
      : file(std::move(opened)), options(chosen) {}

  void record_step(const model::StepReport& report);
  void record_frame(const World& world);
  void record_contacts(const World& world);
  void sync_columns(const World& world);
  void remember(const World& world);
  void write_pending();
  void write(bool with_checkpoint);

  Hdf5File file;
  RecorderOptions options;
  Pending pending;
  std::map<std::uint32_t, std::uint32_t> columns;  // body id -> column in the file
  std::size_t shapes_written = 0;
  std::uint64_t frames = 0;  // rows, pending ones included
  std::uint64_t steps = 0;
  std::uint64_t contacts = 0;
  std::uint64_t next_frame = 0;
  Checkpoint latest;  // the world as it was last known to be well
  bool is_open = true;
  Stopwatch since_flush;
  Stopwatch since_checkpoint;
};

// ---- frames ------------------------------------------------------------------------------------

void Recorder::State::sync_columns(const World& world) {
  std::vector<model::BodyIndex> added;
  for (model::BodyIndex i = 0; i < world.bodies().size(); ++i) {
    const auto column = static_cast<std::uint32_t>(columns.size());
    if (columns.try_emplace(world.id(i).value, column).second) added.push_back(i);
  }
  for (; shapes_written < world.shapes().size(); ++shapes_written) {
    layout::write_shape(file, shapes_written, *world.shapes()[shapes_written]);
  }
  if (added.empty()) return;
  layout::append_bodies(file, world, added);
  if (frames > 0) {
    write_pending();  // rows of the old width
    file.set_columns("/frames/pose", columns.size());
    file.set_columns("/frames/velocity", columns.size());
  }
}

void Recorder::State::record_frame(const World& world) {
  sync_columns(world);
  const model::BodyState& bodies = world.bodies();
  const std::size_t pose = pending.pose.size();
  const std::size_t velocity = pending.velocity.size();
  constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();  // removed bodies
  pending.pose.resize(pose + 7 * columns.size(), kAbsent);
  pending.velocity.resize(velocity + 6 * columns.size(), kAbsent);
  for (model::BodyIndex i = 0; i < bodies.size(); ++i) {
    const std::size_t column = columns.at(world.id(i).value);
    const Pose X_WM = bodies.mesh_pose(i);
    const double p[7] = {X_WM.p.x(), X_WM.p.y(), X_WM.p.z(), X_WM.q.w(),
                         X_WM.q.x(), X_WM.q.y(), X_WM.q.z()};
    std::copy(std::begin(p), std::end(p),
              pending.pose.begin() + static_cast<std::ptrdiff_t>(pose + 7 * column));
    const double v[6] = {bodies.v_W[i].x(), bodies.v_W[i].y(), bodies.v_W[i].z(),
                         bodies.w_W[i].x(), bodies.w_W[i].y(), bodies.w_W[i].z()};
    std::copy(std::begin(v), std::end(v),
              pending.velocity.begin() + static_cast<std::ptrdiff_t>(velocity + 6 * column));
  }
  pending.frame_t.push_back(world.time());
  pending.frame_step.push_back(world.step_count());
  pending.hash.push_back(world.state_hash().hex());
  if (options.contacts) record_contacts(world);
  pending.contact_offset.push_back(contacts);
  ++frames;
  next_frame = frame_after(world.time(), options.fps);
  remember(world);
}

void Recorder::State::record_contacts(const World& world) {
  const model::ContactSet& set = world.contacts();
  for (const model::ContactPair& pair : set.pairs) {
    const std::uint32_t a = columns.at(world.id(pair.body_a).value);
    const std::uint32_t b = columns.at(world.id(pair.body_b).value);
    for (std::uint32_t c = pair.begin; c < pair.end; ++c) {
      pending.contact_pair.insert(pending.contact_pair.end(), {a, b});
      push(pending.contact_point, set.point_W[c]);
      push(pending.contact_normal, set.normal_W[c]);
      pending.contact_gap.push_back(static_cast<float>(set.gap[c]));
      push(pending.contact_impulse, world.contact_impulses()[c]);
    }
  }
  contacts += set.size();
}

void Recorder::State::record_step(const model::StepReport& r) {
  pending.step_t.push_back(r.time);
  pending.step_dt.push_back(r.dt);
  pending.step_energy.insert(pending.step_energy.end(),
                             {r.energy.kinetic, r.energy.potential, r.energy.correction});
  pending.step_residual.push_back(r.solve.residual);
  pending.step_contacts.push_back(r.contacts);
  pending.step_pairs.push_back(r.pairs);
  pending.step_overlap.insert(pending.step_overlap.end(), {r.max_overlap, r.mean_overlap});
  for (const double seconds : {r.collision_s, r.impulse_s, r.integration_s, r.other_s}) {
    pending.step_ms.push_back(static_cast<float>(1e3 * seconds));
  }
  ++steps;
}

void Recorder::State::remember(const World& world) {
  latest = {frames, steps, contacts, ids_of(world), world.state_hash().hex(), world.snapshot()};
}

// ---- writing -----------------------------------------------------------------------------------

void Recorder::State::write_pending() {
  file.append_rows("/frames/t", pending.frame_t);
  file.append_rows("/frames/step", pending.frame_step);
  file.append_rows("/frames/pose", pending.pose);
  file.append_rows("/frames/velocity", pending.velocity);
  file.append_texts("/frames/hash", pending.hash);
  file.append_rows("/contacts/offset", pending.contact_offset);
  file.append_rows("/contacts/pair", pending.contact_pair);
  file.append_rows("/contacts/point", pending.contact_point);
  file.append_rows("/contacts/normal", pending.contact_normal);
  file.append_rows("/contacts/gap", pending.contact_gap);
  file.append_rows("/contacts/impulse", pending.contact_impulse);
  file.append_rows("/steps/t", pending.step_t);
  file.append_rows("/steps/dt", pending.step_dt);
  file.append_rows("/steps/energy", pending.step_energy);
  file.append_rows("/steps/residual", pending.step_residual);
  file.append_rows("/steps/contacts", pending.step_contacts);
  file.append_rows("/steps/pairs", pending.step_pairs);
  file.append_rows("/steps/overlap", pending.step_overlap);
  file.append_rows("/steps/ms", pending.step_ms);
  pending = {};
}

void Recorder::State::write(bool with_checkpoint) {
  try {
    write_pending();
    if (with_checkpoint) file.replace_rows("/checkpoint/state", to_bytes(latest));
    file.flush();
  } catch (...) {
    is_open = false;  // what was flushed before is what remains
    throw;
  }
  since_flush.lap();
  if (with_checkpoint) since_checkpoint.lap();
}

// ---- the class ---------------------------------------------------------------------------------

Recorder::Recorder(std::unique_ptr<State> state) : state_(std::move(state)) {}
Recorder::Recorder(Recorder&&) noexcept = default;

Recorder::Recorder(const std::string& path, const World& world, const SceneSource& scene,
                   const RecorderOptions& options)
    : state_(std::make_unique<State>(Hdf5File::create(path), options)) {
  layout::write_start(state_->file, world, scene, options);
  state_->pending.contact_offset.push_back(0);
  state_->record_frame(world);
  state_->write(true);
}

Recorder Recorder::resume(const std::string& path, World& world, const RecorderOptions& options) {
  auto state = std::make_unique<State>(Hdf5File::append(path), options);
  Hdf5File& file = state->file;
  const Checkpoint checkpoint =
      from_bytes(file.read_all<std::uint8_t>("/checkpoint/state", {}), path);
  if (checkpoint.ids != ids_of(world)) {
    throw FileError(path, "was recorded with other bodies than the scene has now");
  }
  for (const auto& shape : world.shapes()) {
    const std::string name = fmt::format("/shapes/{}/content", state->shapes_written++);
    if (!file.exists(name) || file.read_text(name) != shape->content.hex()) {
      throw FileError(path, fmt::format("was recorded with another shape \"{}\" than the scene has "
                                        "now: its mesh or level changed",
                                        shape->name));
    }
  }
  world.restore(checkpoint.snapshot);
  if (world.state_hash().hex() != checkpoint.state_hash) {
    throw FileError(path, "the state of its checkpoint cannot be restored exactly");
  }
  const auto ids = file.read_all<std::uint32_t>("/bodies/id", {});
  for (std::size_t i = 0; i < ids.size(); ++i)
    state->columns[ids[i]] = static_cast<std::uint32_t>(i);
  for (const layout::Table& table : layout::frame_tables(0))
    file.resize(table.name, checkpoint.frames);
  file.resize("/frames/hash", checkpoint.frames);
  for (const layout::Table& table : layout::contact_tables()) {
    file.resize(table.name, checkpoint.contacts);
  }
  file.resize("/contacts/offset", checkpoint.frames + 1);
  for (const layout::Table& table : layout::step_tables())
    file.resize(table.name, checkpoint.steps);
  file.remove("/certificate");
  state->frames = checkpoint.frames;
  state->steps = checkpoint.steps;
  state->contacts = checkpoint.contacts;
  state->next_frame = frame_after(world.time(), options.fps);
  state->remember(world);
  return Recorder(std::move(state));
}

Recorder::~Recorder() {
  if (!state_ || !state_->is_open) return;
  try {
    state_->write(true);  // the run was stopped by an error: keep what there is
  } catch (const Error&) {
    // Nothing can be done here; what was flushed before is kept.
  }
}

void Recorder::on_step(const World& world, const model::StepReport& report) {
  State& s = *state_;
  if (!s.is_open) throw FileError(s.file.path(), "the recording has ended");
  s.record_step(report);
  const double due = static_cast<double>(s.next_frame);
  if (world.time() * s.options.fps + kTimeSlack >= due) s.record_frame(world);
  const bool checkpoint_is_due =
      s.options.checkpoint > 0.0 && s.since_checkpoint.seconds() >= s.options.checkpoint;
  if (checkpoint_is_due || s.since_flush.seconds() >= s.options.flush ||
      s.pending.size() > kMostPending) {
    s.write(checkpoint_is_due);
  }
}

void Recorder::checkpoint(const World& world) {
  state_->remember(world);
  state_->write(true);
}

void Recorder::flush() { state_->write(false); }

void Recorder::finish(const World& world, const std::string& certificate) {
  state_->file.write_text("/certificate", certificate);
  checkpoint(world);
  state_->is_open = false;
}

std::uint64_t Recorder::frame_count() const { return state_->frames; }
const std::string& Recorder::path() const { return state_->file.path(); }

}  // namespace gotai::recording
