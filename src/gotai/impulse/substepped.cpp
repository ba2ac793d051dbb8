#include "gotai/impulse/substepped.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "gotai/core/parallel.h"
#include "gotai/impulse/lanes.h"
#include "gotai/impulse/sliding.h"

namespace gotai::impulse {
namespace {

// Smallest numbers worth a task of their own.
constexpr std::size_t kPairGrain = 64;
constexpr std::size_t kBodyGrain = 256;
constexpr std::size_t kLeastPerWave = 3;  // batches, about 1 us each

constexpr int kSubsteps = 8;
// Islands of at most so many contacts are stacks.
constexpr std::uint32_t kLargestStack = 256;
// By kind of island. Ten sweeps of either sort let ten cubes stand on top of each other. Overlap
// recovers like a spring with a share of the sub-step rate, heavily damped (doubled against bodies
// that do not move). Half the share leaves piles half as deep again in each other; more of it
// shakes stacks.
struct Effort {
  std::uint32_t biased_sweeps;
  std::uint32_t relax_sweeps;
  double frequency_share;
};
constexpr std::array<Effort, kIslandKinds> kEffort = {{{10, 10, 0.5}, {2, 4, 0.5}, {1, 2, 0.65}}};
constexpr double kDampingRatio = 10.0;

struct Softness {
  double bias_rate;  // [1/s]
  double mass_scale;
  double impulse_scale;
};

/// Soft constraint of an implicit damped spring [Catto 2011, "Soft Constraints"].
Softness softness(double frequency_hz, double h) {
  const double omega = 2.0 * std::numbers::pi * frequency_hz;
  const double a1 = 2.0 * kDampingRatio + h * omega;
  const double a2 = h * omega * a1;
  const double a3 = 1.0 / (1.0 + a2);
  return {omega / a1, a2 * a3, a3};
}

// Stands for a pair as a whole in the memory, after its contacts: the impulse against rolling.
constexpr model::FeatureKey kRollingFeature = std::numeric_limits<model::FeatureKey>::max();

// Number by number: a copy of what was just written in parts would wait for the parts.
void set_velocity(const Vec3& v, const Vec3& w, SoftBody& now, SoftBody& before) {
  for (int c = 0; c < 3; ++c) {
    now.v[c] = before.v[c] = static_cast<float>(v[c]);
    now.w[c] = before.w[c] = static_cast<float>(w[c]);
  }
}

// Impulse of a contact [N s], W, from its parts along n, t and n x t.
inline void write_impulse(const ContactRow& row, std::size_t l, const Lane& p_n, const Lane& p_1,
                          const Lane& p_2, Vec3& impulse) {
  const auto at = [l](const Lane& lane) { return static_cast<double>(lane.value[l]); };
  const double n[3] = {at(row.n.x), at(row.n.y), at(row.n.z)};
  const double t[3] = {at(row.t.x), at(row.t.y), at(row.t.z)};
  const double normal = at(p_n), along_t = at(p_1), across = at(p_2);
  for (int c = 0; c < 3; ++c) {
    const int d = (c + 1) % 3, e = (c + 2) % 3;
    impulse[c] = normal * n[c] + along_t * t[c] + across * (n[d] * t[e] - n[e] * t[d]);
  }
}

}  // namespace

SubsteppedConstraint::SubsteppedConstraint(const model::Settings& settings) : settings_(settings) {}

model::StepPlan SubsteppedConstraint::plan(const model::BodyState& bodies, double dt) const {
  model::StepPlan plan;
  plan.dt = dt;
  plan.substeps = kSubsteps;
  plan.relax = true;
  // Contacts exist before touching: within what the fastest body covers in a step.
  double fastest = 0.0;
  for (model::BodyIndex i = 0; i < bodies.size(); ++i)
    fastest =
        std::max(fastest, bodies.v_W[i].norm() + bodies.bounding_radius[i] * bodies.w_W[i].norm());
  plan.contact_margin = 2.0 * dt * (fastest + settings_.gravity.norm() * dt);
  return plan;
}

void SubsteppedConstraint::prepare(const model::BodyState& bodies,
                                   const model::ContactSet& contacts,
                                   const model::MaterialTable& materials,
                                   const model::StepPlan& plan,
                                   const model::ContactMemory& memory) {
  contacts_ = &contacts;
  plan_ = plan;
  substep_ = 0;
  schedule_ = &scheduler_.build(bodies, contacts, kLargestStack);
  parallel_for(2, 1, [&](std::size_t task) {
    if (task == 0) {
      lay_out_batches();
    } else {
      find_memories(memory);
      read_velocities(bodies);
    }
  });
  // As stages, so that rows get into the caches of those who will sweep them.
  add_at_once(SoftPass::prepare);
  run_stages(stages_, kLeastPerWave, [&](SoftPass pass, std::uint32_t first, std::uint32_t count) {
    for (std::uint32_t k = first; k < first + count; ++k) fill_batch(k, bodies, materials, memory);
    soft_pass(pass, problem(), first, count);
  });
  stages_.clear();
  share_loads();
  report_ = {};
  report_.rows = static_cast<std::uint32_t>(contacts.size());
  report_.substeps = static_cast<std::uint32_t>(plan.substeps);
  for (std::size_t kind = 0; kind < kIslandKinds; ++kind) {
    if (waves_[kind].empty()) continue;
    report_.iterations =
        std::max(report_.iterations,
                 report_.substeps * (kEffort[kind].biased_sweeps + kEffort[kind].relax_sweeps));
  }
}

void SubsteppedConstraint::lay_out_batches() {
  batches_.clear();
  in_batch_.clear();
  slots_.resize(contacts_->size());
  is_sliding_.resize(contacts_->pairs.size());
  for (std::vector<Range>& waves : waves_) waves.clear();
  std::uint32_t rows = 0;
  std::size_t kind = 0;
  for (std::uint32_t wave = 0; wave < schedule_->waves(); ++wave) {
    while (wave >= schedule_->kind_begin[kind + 1]) ++kind;
    const auto first_batch = static_cast<std::uint32_t>(batches_.size());
    const std::uint32_t end = schedule_->wave_begin[wave + 1];
    for (std::uint32_t first = schedule_->wave_begin[wave]; first < end; first += kLanes) {
      PairBatch& batch = batches_.emplace_back();
      in_batch_.push_back({first, static_cast<std::uint32_t>(kind)});
      batch.lanes = std::min(static_cast<std::uint32_t>(kLanes), end - first);
      batch.row_begin = rows;
      std::uint32_t longest = 0;
      for (std::uint32_t lane = 0; lane < batch.lanes; ++lane) {
        const model::ContactPair& pair = contacts_->pairs[schedule_->pair[first + lane]];
        for (std::uint32_t c = pair.begin; c < pair.end; ++c)
          slots_[c] = {rows + (c - pair.begin), lane};
        longest = std::max(longest, pair.size());
      }
      rows += longest;
      batch.row_end = rows;
    }
    waves_[kind].push_back({first_batch, static_cast<std::uint32_t>(batches_.size())});
  }
  rows_.resize(rows);
  if (settings_.impulse.rolling_resistance > 0.0) {
    rolling_.resize(batches_.size());
    rolling_slots_.resize(contacts_->pairs.size());
  }
}

void SubsteppedConstraint::fill_batch(std::size_t k, const model::BodyState& bodies,
                                      const model::MaterialTable& materials,
                                      const model::ContactMemory& memory) {
  const double h = plan_.substep_dt();
  const double frequency_hz = kEffort[in_batch_[k].kind].frequency_share / h;
  const Softness moving = softness(frequency_hz, h);
  const Softness fixed = softness(2.0 * frequency_hz, h);
  PairBatch& batch = batches_[k];
  std::fill(rows_.begin() + batch.row_begin, rows_.begin() + batch.row_end, ContactRow{});
  if (!rolling_.empty()) rolling_[k] = {};
  for (std::uint32_t l = 0; l < batch.lanes; ++l) {
    const std::uint32_t p = schedule_->pair[in_batch_[k].first_pair + l];
    const model::ContactPair& pair = contacts_->pairs[p];
    const model::BodyIndex a = pair.body_a;
    const model::BodyIndex b = pair.body_b;
    batch.body_a[l] = a + 1;
    batch.body_b[l] = b + 1;
    if (bodies.is_dynamic(a)) batch.dynamic_a |= 1U << l;
    if (bodies.is_dynamic(b)) batch.dynamic_b |= 1U << l;
    set(batch.offset, l, bodies.x_W[a] - bodies.x_W[b]);
    set(batch.inverse_mass_a, l, bodies.inverse_mass[a]);
    set(batch.inverse_mass_b, l, bodies.inverse_mass[b]);
    set(batch.inverse_I_a, l, bodies.inverse_I_W[a]);
    set(batch.inverse_I_b, l, bodies.inverse_I_W[b]);
    const model::SurfacePair surface = materials.combine(bodies.material[a], bodies.material[b]);
    set(batch.restitution, l, surface.restitution);
    const bool both_move = bodies.is_dynamic(a) && bodies.is_dynamic(b);
    const Softness& soft = both_move ? moving : fixed;
    set(batch.bias_rate, l, soft.bias_rate);
    set(batch.mass_scale, l, soft.mass_scale);
    set(batch.impulse_scale, l, soft.impulse_scale);
    // Three diameters of the smaller body per second: deep overlaps part without a bang.
    const double size = both_move ? std::min(bodies.bounding_radius[a], bodies.bounding_radius[b])
                                  : std::max(bodies.bounding_radius[a], bodies.bounding_radius[b]);
    set(batch.push_limit, l, 6.0 * size);
    if (!rolling_.empty()) fill_rolling(p, k, l, bodies, memory);
    fill_rows(p, l, batch.row_begin, surface.friction, bodies.x_W[a], memory);
    is_sliding_[p] = is_sliding(bodies, *contacts_, pair, settings_.gravity.norm() * plan_.dt);
    if (is_sliding_[p]) slide(pair, surface.friction, bodies.x_W[a]);
  }
}

void SubsteppedConstraint::fill_rows(std::uint32_t p, std::size_t lane, std::uint32_t row_begin,
                                     double friction, const Vec3& x_a,
                                     const model::ContactMemory& memory) {
  const model::ContactPair& pair = contacts_->pairs[p];
  auto [m, end] = memory_of_[p];
  for (std::uint32_t c = pair.begin; c < pair.end; ++c) {
    ContactRow& row = rows_[row_begin + (c - pair.begin)];
    set(row.n, lane, contacts_->normal_W[c]);
    set(row.j_a, lane, contacts_->point_W[c] - x_a);
    set(row.f_a, lane, contacts_->friction_W[c] - x_a);
    set(row.friction, lane, friction);
    set(row.gap, lane, contacts_->gap[c]);
    while (m < end && memory.entries[m].feature < contacts_->feature[c]) ++m;
    if (m == end || memory.entries[m].feature != contacts_->feature[c]) continue;
    const Vec3& impulse = memory.entries[m].impulse_W;
    set(row.p_n, lane, impulse.x());
    set(row.p_1, lane, impulse.y());
    set(row.p_2, lane, impulse.z());
  }
}

void SubsteppedConstraint::fill_rolling(std::uint32_t p, std::size_t k, std::uint32_t lane,
                                        const model::BodyState& bodies,
                                        const model::ContactMemory& memory) {
  const auto [a, b, begin, end] = contacts_->pairs[p];
  RollingBatch& rolling = rolling_[k];
  rolling_slots_[p] = {static_cast<std::uint32_t>(k), lane};
  set(rolling.arm, lane, rolling_arm(bodies, a, b));
  const auto softest = [&](model::BodyIndex i) {
    return bodies.is_dynamic(i) ? 1.0 / bodies.principal_moments[i][0] : 0.0;
  };
  set(rolling.mass, lane, 1.0 / (softest(a) + softest(b)));
  const auto [first, last] = memory_of_[p];
  if (first < last && memory.entries[last - 1].feature == kRollingFeature)
    set(rolling.impulse, lane, memory.entries[last - 1].impulse_W);
}

double SubsteppedConstraint::rolling_arm(const model::BodyState& bodies, model::BodyIndex a,
                                         model::BodyIndex b) const {
  const double radius = bodies.is_dynamic(b)
                            ? std::min(bodies.bounding_radius[a], bodies.bounding_radius[b])
                            : bodies.bounding_radius[a];
  const double speed = radius * (bodies.w_W[a] - bodies.w_W[b]).norm();
  // What rolls in earnest is hardly braked: the resistance at rest falls by the square of the
  // speed.
  const double slow = 0.5 * settings_.gravity.norm() * plan_.dt;
  const double share = speed > slow ? (slow / speed) * (slow / speed) : 1.0;
  return radius * std::max(settings_.impulse.rolling_resistance, share * model::kRestingResistance);
}

void SubsteppedConstraint::find_memories(const model::ContactMemory& memory) {
  const auto key = [](model::BodyIndex a, model::BodyIndex b) {
    return static_cast<std::uint64_t>(a) << 32U | b;
  };
  const auto key_of = [&](std::uint32_t k) {
    return key(memory.entries[k].body_a, memory.entries[k].body_b);
  };
  // Pairs and entries are sorted by (body_a, body_b).
  const auto count = static_cast<std::uint32_t>(memory.entries.size());
  memory_of_.resize(contacts_->pairs.size());
  std::uint32_t m = 0;
  for (std::size_t p = 0; p < contacts_->pairs.size(); ++p) {
    const std::uint64_t wanted = key(contacts_->pairs[p].body_a, contacts_->pairs[p].body_b);
    while (m < count && key_of(m) < wanted) ++m;
    memory_of_[p].begin = m;
    while (m < count && key_of(m) == wanted) ++m;
    memory_of_[p].end = m;
  }
}

void SubsteppedConstraint::read_velocities(const model::BodyState& bodies) {
  velocity_.resize(bodies.size() + 1);
  velocity_[0] = {};
  before_.resize(bodies.size() + 1);
  parallel_for(bodies.size(), kBodyGrain, [&](std::size_t i) {
    set_velocity(bodies.v_W[i], bodies.w_W[i], velocity_[i + 1], before_[i + 1]);
  });
}

void SubsteppedConstraint::write_changes(const model::BodyState& bodies,
                                         model::Update& update) const {
  parallel_for(bodies.size(), kBodyGrain, [&](std::size_t k) {
    const auto i = static_cast<model::BodyIndex>(k);
    if (!bodies.is_dynamic(i)) return;
    const SoftBody& now = velocity_[i + 1];
    const SoftBody& then = before_[i + 1];
    Vec3 delta_w;
    for (int c = 0; c < 3; ++c) {
      update.delta_v[i][c] = static_cast<double>(now.v[c]) - static_cast<double>(then.v[c]);
      delta_w[c] = static_cast<double>(now.w[c]) - static_cast<double>(then.w[c]);
    }
    update.delta_L[i] = model::angular_momentum(bodies, i, delta_w);
  });
}

SoftProblem SubsteppedConstraint::problem() {
  return {velocity_.data(),
          batches_.data(),
          rows_.data(),
          rolling_.empty() ? nullptr : rolling_.data(),
          static_cast<float>(plan_.substep_dt()),
          static_cast<float>(2.0 * settings_.gravity.norm() * plan_.dt)};
}

void SubsteppedConstraint::add_waves(std::size_t kind, SoftPass pass) {
  for (const Range& wave : waves_[kind])
    stages_.push_back({pass, wave.begin, wave.end - wave.begin});
}

void SubsteppedConstraint::add_at_once(SoftPass pass) {
  const std::size_t first = stages_.size();
  for (std::size_t kind = 0; kind < kIslandKinds; ++kind) add_waves(kind, pass);
  for (std::size_t s = first + 1; s < stages_.size(); ++s) stages_[s].waits = false;
}

void SubsteppedConstraint::run_passes() {
  const SoftProblem all = problem();
  run_stages(stages_, kLeastPerWave, [&](SoftPass pass, std::uint32_t first, std::uint32_t count) {
    soft_pass(pass, all, first, count);
  });
  stages_.clear();
}

void SubsteppedConstraint::solve(const model::BodyState& bodies, const std::vector<double>& /*gap*/,
                                 model::Update& update) {
  read_velocities(bodies);
  if (substep_++ == 1 && !contacts_->sliding.empty()) press_shares();
  for (std::size_t kind = 0; kind < kIslandKinds; ++kind) {
    add_waves(kind, SoftPass::warm_start);
    for (std::uint32_t n = 0; n < kEffort[kind].biased_sweeps; ++n)
      add_waves(kind, SoftPass::biased);
  }
  run_passes();
  write_changes(bodies, update);
}

void SubsteppedConstraint::relax(const model::BodyState& bodies, model::Update& update) {
  read_velocities(bodies);
  add_at_once(SoftPass::advance_gaps);
  for (std::size_t kind = 0; kind < kIslandKinds; ++kind) {
    for (std::uint32_t n = 1; n < kEffort[kind].relax_sweeps; ++n) add_waves(kind, SoftPass::relax);
    add_waves(kind, SoftPass::relax_last);
  }
  run_passes();
  write_changes(bodies, update);
}

void SubsteppedConstraint::remember(model::ContactMemory& memory) {
  // Also contacts that only carried for a while: forgotten, they may be left out of the next step's
  // reduction and found again a step later, deeper.
  const auto carried = [&](std::uint32_t c) {
    return rows_[slots_[c].row].total_n.value[slots_[c].lane] > 0.0F;
  };
  const std::vector<model::ContactPair>& pairs = contacts_->pairs;
  entry_of_.assign(pairs.size() + 1, 0);
  parallel_for(pairs.size(), kPairGrain, [&](std::size_t p) {
    for (std::uint32_t c = pairs[p].begin; c < pairs[p].end; ++c)
      entry_of_[p + 1] += carried(c) ? 1U : 0U;
    if (!rolling_.empty() && entry_of_[p + 1] > 0) ++entry_of_[p + 1];
  });
  for (std::size_t p = 0; p < pairs.size(); ++p) entry_of_[p + 1] += entry_of_[p];
  memory.entries.resize(entry_of_.back());
  parallel_for(pairs.size(), kPairGrain, [&](std::size_t p) {
    std::uint32_t m = entry_of_[p];
    for (std::uint32_t c = pairs[p].begin; c < pairs[p].end; ++c) {
      if (!carried(c)) continue;
      model::ContactMemory::Entry& entry = memory.entries[m++];
      entry.body_a = pairs[p].body_a;
      entry.body_b = pairs[p].body_b;
      entry.feature = contacts_->feature[c];
      const auto& [r, l] = slots_[c];
      write_impulse(rows_[r], l, rows_[r].p_n, rows_[r].p_1, rows_[r].p_2, entry.impulse_W);
    }
    if (m == entry_of_[p + 1]) return;
    const auto [k, lane] = rolling_slots_[p];
    memory.entries[m] = {pairs[p].body_a, pairs[p].body_b, kRollingFeature,
                         get(rolling_[k].impulse, lane)};
  });
}

void SubsteppedConstraint::finish(const model::BodyState& bodies, model::Update& update,
                                  model::ContactMemory& memory) {
  remember(memory);
  read_velocities(bodies);
  report_.residual = soft_residual(problem(), batches_.size());
  for (std::size_t kind = 0; kind < kIslandKinds; ++kind) add_waves(kind, SoftPass::restitution);
  run_passes();
  write_changes(bodies, update);
  parallel_for(contacts_->size(), kBodyGrain, [&](std::size_t k) {
    const auto c = static_cast<std::uint32_t>(k);
    const auto& [r, l] = slots_[c];
    write_impulse(rows_[r], l, rows_[r].total_n, rows_[r].total_1, rows_[r].total_2,
                  update.contact_impulse[c]);
  });
}

}  // namespace gotai::impulse
