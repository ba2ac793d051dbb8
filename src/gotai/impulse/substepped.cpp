#include "gotai/impulse/substepped.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "gotai/core/parallel.h"
#include "gotai/impulse/lanes.h"

namespace gotai::impulse {
namespace {

// Smallest numbers worth a task of their own.
constexpr std::size_t kBatchGrain = 8;  // about 10 us of a sweep
constexpr std::size_t kPairGrain = 32;
constexpr std::size_t kBodyGrain = 256;

constexpr int kSubsteps = 8;
constexpr int kRelaxSweeps = 2;
// Overlap recovers like a spring with half of the sub-step rate, heavily damped (doubled against
// bodies that do not move). A quarter leaves piles half as deep again in each other.
constexpr double kDampingRatio = 10.0;
constexpr double kFrequencyShare = 0.5;

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

/// Calls kernel(first, count) for consecutive groups of batches [begin, end), on any thread.
template <typename Kernel>
void for_batches(std::size_t begin, std::size_t end, const Kernel& kernel) {
  const std::size_t groups = (end - begin + kBatchGrain - 1) / kBatchGrain;
  parallel_for(groups, 1, [&](std::size_t g) {
    const std::size_t first = begin + g * kBatchGrain;
    kernel(first, std::min(kBatchGrain, end - first));
  });
}

/// A unit vector across n that turns smoothly with it on each side of the switch.
Vec3 tangent(const Vec3& n) {
  const Vec3 axis = std::abs(n.x()) < 0.6 ? Vec3::UnitX() : Vec3::UnitY();
  return n.cross(axis).normalized();
}

SoftBody to_soft(const Vec3& v, const Vec3& w) {
  SoftBody body;
  for (int c = 0; c < 3; ++c) {
    body.v[c] = static_cast<float>(v[c]);
    body.w[c] = static_cast<float>(w[c]);
  }
  return body;
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
  counts_.resize(contacts.pairs.size());
  for (std::size_t p = 0; p < contacts.pairs.size(); ++p) counts_[p] = contacts.pairs[p].size();
  lay_out_batches(bodies, materials);
  fill_rows(bodies);
  load_warm_start(memory);
  share_loads(bodies);
  report_ = {};
  report_.rows = static_cast<std::uint32_t>(slots_.size());
  report_.substeps = static_cast<std::uint32_t>(plan.substeps);
  report_.iterations = static_cast<std::uint32_t>(plan.substeps * (1 + kRelaxSweeps));
}

void SubsteppedConstraint::lay_out_batches(const model::BodyState& bodies,
                                           const model::MaterialTable& materials) {
  const ContactSchedule& schedule = scheduler_.build(bodies, *contacts_, counts_);
  const double h = plan_.substep_dt();
  const Softness moving = softness(kFrequencyShare / h, h);
  const Softness fixed = softness(2.0 * kFrequencyShare / h, h);
  batches_.clear();
  wave_end_.clear();
  slots_.resize(contacts_->size());
  std::uint32_t rows = 0;
  for (std::size_t wave = 0; wave < schedule.waves(); ++wave) {
    for (std::uint32_t first = schedule.wave_begin[wave]; first < schedule.wave_begin[wave + 1];
         first += kLanes) {
      PairBatch& batch = batches_.emplace_back();
      batch.row_begin = rows;
      const std::uint32_t last =
          std::min(first + static_cast<std::uint32_t>(kLanes), schedule.wave_begin[wave + 1]);
      std::uint32_t longest = 0;
      for (std::uint32_t k = first; k < last; ++k) {
        const std::size_t l = k - first;
        const model::ContactPair& pair = contacts_->pairs[schedule.pair[k]];
        const model::BodyIndex a = pair.body_a;
        const model::BodyIndex b = pair.body_b;
        batch.body_a[l] = static_cast<std::int32_t>(a) + 1;
        batch.body_b[l] = static_cast<std::int32_t>(b) + 1;
        if (bodies.is_dynamic(a)) batch.dynamic_a |= 1U << l;
        if (bodies.is_dynamic(b)) batch.dynamic_b |= 1U << l;
        set(batch.inverse_mass_a, l, bodies.inverse_mass[a]);
        set(batch.inverse_mass_b, l, bodies.inverse_mass[b]);
        set(batch.inverse_I_a, l, bodies.inverse_I_W[a]);
        set(batch.inverse_I_b, l, bodies.inverse_I_W[b]);
        const model::SurfacePair surface =
            materials.combine(bodies.material[a], bodies.material[b]);
        set(batch.friction, l, surface.friction);
        set(batch.restitution, l, surface.restitution);
        const bool both_move = bodies.is_dynamic(a) && bodies.is_dynamic(b);
        const Softness& soft = both_move ? moving : fixed;
        set(batch.bias_rate, l, soft.bias_rate);
        set(batch.mass_scale, l, soft.mass_scale);
        set(batch.impulse_scale, l, soft.impulse_scale);
        // Three diameters of the smaller body per second: deep overlaps part without a bang.
        const double size = both_move
                                ? std::min(bodies.bounding_radius[a], bodies.bounding_radius[b])
                                : std::max(bodies.bounding_radius[a], bodies.bounding_radius[b]);
        set(batch.push_limit, l, 6.0 * size);
        for (std::uint32_t c = pair.begin; c < pair.end; ++c)
          slots_[c] = {c, rows + (c - pair.begin), static_cast<std::uint32_t>(l)};
        longest = std::max(longest, pair.size());
      }
      rows += longest;
      batch.row_end = rows;
    }
    wave_end_.push_back(batches_.size());
  }
  rows_.assign(rows, ContactRow{});
}

void SubsteppedConstraint::fill_rows(const model::BodyState& bodies) {
  parallel_for(contacts_->pairs.size(), kPairGrain, [&](std::size_t p) {
    const model::ContactPair& pair = contacts_->pairs[p];
    const model::BodyIndex a = pair.body_a;
    const model::BodyIndex b = pair.body_b;
    const Mat3& inverse_I_a = bodies.inverse_I_W[a];
    const Mat3& inverse_I_b = bodies.inverse_I_W[b];
    const double inverse_mass = bodies.inverse_mass[a] + bodies.inverse_mass[b];
    for (std::uint32_t c = pair.begin; c < pair.end; ++c) {
      ContactRow& row = rows_[slots_[c].row];
      const std::size_t l = slots_[c].lane;
      const Vec3& n = contacts_->normal_W[c];
      const Vec3 r_a = contacts_->point_W[c] - bodies.x_W[a];
      const Vec3 r_b = contacts_->point_W[c] - bodies.x_W[b];
      const Vec3 f_a = contacts_->friction_W[c] - bodies.x_W[a];
      const Vec3 f_b = contacts_->friction_W[c] - bodies.x_W[b];
      const Vec3 t1 = tangent(n);
      const Vec3 t2 = n.cross(t1);
      const Vec3 j_a = r_a.cross(n);
      const Vec3 j_b = r_b.cross(n);
      const auto coupling = [&](const Vec3& u, const Vec3& v) {
        return f_a.cross(u).dot(inverse_I_a * f_a.cross(v)) +
               f_b.cross(u).dot(inverse_I_b * f_b.cross(v));
      };
      const double k_11 = inverse_mass + coupling(t1, t1);
      const double k_22 = inverse_mass + coupling(t2, t2);
      const double k_12 = coupling(t1, t2);
      const double determinant = k_11 * k_22 - k_12 * k_12;
      set(row.n, l, n);
      set(row.j_a, l, j_a);
      set(row.j_b, l, j_b);
      set(row.t, l, t1);
      set(row.f_a, l, f_a);
      set(row.f_b, l, f_b);
      set(row.gap, l, contacts_->gap[c]);
      set(row.mass_n, l,
          1.0 / (inverse_mass + j_a.dot(inverse_I_a * j_a) + j_b.dot(inverse_I_b * j_b)));
      set(row.k11, l, k_22 / determinant);
      set(row.k12, l, -k_12 / determinant);
      set(row.k22, l, k_11 / determinant);
      set(row.mass_t, l, 2.0 / (k_11 + k_22));
      const Vec3 v = bodies.v_W[a] - bodies.v_W[b];
      set(row.approach, l, n.dot(v) + j_a.dot(bodies.w_W[a]) - j_b.dot(bodies.w_W[b]));
    }
  });
}

void SubsteppedConstraint::load_warm_start(const model::ContactMemory& memory) {
  // Both lists are sorted by (body_a, body_b, feature): one merge.
  std::size_t m = 0;
  for (const model::ContactPair& pair : contacts_->pairs)
    for (std::uint32_t c = pair.begin; c < pair.end; ++c) {
      const auto key = std::tuple(pair.body_a, pair.body_b, contacts_->feature[c]);
      while (m < memory.entries.size() &&
             std::tuple(memory.entries[m].body_a, memory.entries[m].body_b,
                        memory.entries[m].feature) < key)
        ++m;
      if (m == memory.entries.size()) return;
      const model::ContactMemory::Entry& entry = memory.entries[m];
      if (std::tuple(entry.body_a, entry.body_b, entry.feature) != key) continue;
      ContactRow& row = rows_[slots_[c].row];
      const std::size_t l = slots_[c].lane;
      const Vec3 n = contacts_->normal_W[c];
      const Vec3 t1 = tangent(n);
      set(row.p_n, l, std::max(0.0, entry.impulse_W.dot(n)));
      set(row.p_1, l, entry.impulse_W.dot(t1));
      set(row.p_2, l, entry.impulse_W.dot(n.cross(t1)));
    }
}

void SubsteppedConstraint::read_velocities(const model::BodyState& bodies) {
  velocity_.resize(bodies.size() + 1);
  velocity_[0] = {};
  before_.resize(bodies.size() + 1);
  parallel_for(bodies.size(), kBodyGrain, [&](std::size_t i) {
    velocity_[i + 1] = before_[i + 1] = to_soft(bodies.v_W[i], bodies.w_W[i]);
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

template <typename Kernel>
void SubsteppedConstraint::for_waves(const Kernel& kernel) {
  if (thread_count() == 1) return kernel(0, batches_.size());
  std::size_t begin = 0;
  for (const std::size_t end : wave_end_) {
    for_batches(begin, end, kernel);
    begin = end;
  }
}

void SubsteppedConstraint::solve(const model::BodyState& bodies, const std::vector<double>& /*gap*/,
                                 model::Update& update) {
  read_velocities(bodies);
  const auto inverse_h = static_cast<float>(1.0 / plan_.substep_dt());
  for_waves([&](std::size_t first, std::size_t count) {
    soft_warm_start(velocity_.data(), batches_.data() + first, count, rows_.data());
  });
  for_waves([&](std::size_t first, std::size_t count) {
    soft_solve_biased(velocity_.data(), batches_.data() + first, count, rows_.data(), inverse_h);
  });
  write_changes(bodies, update);
}

void SubsteppedConstraint::relax(const model::BodyState& bodies, model::Update& update) {
  read_velocities(bodies);
  const double h = plan_.substep_dt();
  for_batches(0, batches_.size(), [&](std::size_t first, std::size_t count) {
    soft_advance_gaps(velocity_.data(), batches_.data() + first, count, rows_.data(),
                      static_cast<float>(h));
  });
  for (int sweep = 0; sweep < kRelaxSweeps; ++sweep)
    for_waves([&](std::size_t first, std::size_t count) {
      soft_relax(velocity_.data(), batches_.data() + first, count, rows_.data(),
                 static_cast<float>(1.0 / h));
    });
  for_batches(0, batches_.size(), [&](std::size_t first, std::size_t count) {
    soft_accumulate(batches_.data() + first, count, rows_.data());
  });
  write_changes(bodies, update);
}

void SubsteppedConstraint::finish(const model::BodyState& bodies, model::Update& update,
                                  model::ContactMemory& memory) {
  memory.entries.clear();
  const auto impulse_of = [&](const Slot& slot, const Lane& n, const Lane& a, const Lane& b) {
    const ContactRow& row = rows_[slot.row];
    const Vec3 normal = get(row.n, slot.lane);
    const Vec3 t1 = get(row.t, slot.lane);
    return Vec3(n.value[slot.lane] * normal + a.value[slot.lane] * t1 +
                b.value[slot.lane] * normal.cross(t1));
  };
  for (const model::ContactPair& pair : contacts_->pairs)
    for (std::uint32_t c = pair.begin; c < pair.end; ++c) {
      const ContactRow& row = rows_[slots_[c].row];
      // Also contacts that only carried for a while: forgotten, they may be left out of the next
      // step's reduction and found again a step later, deeper.
      if (row.total_n.value[slots_[c].lane] <= 0.0F) continue;
      memory.entries.push_back({pair.body_a, pair.body_b, contacts_->feature[c],
                                impulse_of(slots_[c], row.p_n, row.p_1, row.p_2)});
    }
  read_velocities(bodies);
  const double h = plan_.substep_dt();
  report_.residual = soft_residual(velocity_.data(), batches_.data(), batches_.size(), rows_.data(),
                                   static_cast<float>(1.0 / h));
  for_waves([&](std::size_t first, std::size_t count) {
    soft_restitution(velocity_.data(), batches_.data() + first, count, rows_.data(),
                     static_cast<float>(2.0 * settings_.gravity.norm() * plan_.dt));
  });
  write_changes(bodies, update);
  parallel_for(slots_.size(), kBodyGrain, [&](std::size_t k) {
    const Slot& slot = slots_[k];
    const ContactRow& row = rows_[slot.row];
    update.contact_impulse[slot.contact] = impulse_of(slot, row.total_n, row.total_1, row.total_2);
  });
}

}  // namespace gotai::impulse
