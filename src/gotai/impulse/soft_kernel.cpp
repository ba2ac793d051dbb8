// The kernels, compiled once per instruction set and chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "gotai/impulse/soft_kernel.cpp"
#include <hwy/foreach_target.h>
// foreach_target.h must come first.
#include <hwy/highway.h>

#include "gotai/core/highway_target.h"
#include "gotai/impulse/soft_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace gotai::impulse {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr int kVisitsPerRestitution = 8;

#include "gotai/impulse/soft_lanes.inc"

/// Normal impulse on a, its reaction on b.
HWY_INLINE void push_normal(const PairBatch& batch, std::size_t l, const ContactRow& row, V p,
                            Motion& m) {
  const V3 n = load(row.n, l);
  m.v_a = add_scaled(m.v_a, p * load(batch.inverse_mass_a, l), n);
  m.w_a = add_scaled(m.w_a, p, multiply(batch.inverse_I_a, l, load(row.j_a, l)));
  const V q = zero() - p;
  m.v_b = add_scaled(m.v_b, q * load(batch.inverse_mass_b, l), n);
  m.w_b = add_scaled(m.w_b, q, multiply(batch.inverse_I_b, l, load(row.j_b, l)));
}

HWY_INLINE V3 friction_arm_b(const PairBatch& batch, std::size_t l, const ContactRow& row) {
  return add(load(row.f_a, l), load(batch.offset, l));
}

/// Impulse P at the friction point on a, its reaction on b.
HWY_INLINE void push_friction(const PairBatch& batch, std::size_t l, const ContactRow& row,
                              const V3& P, Motion& m) {
  m.v_a = add_scaled(m.v_a, load(batch.inverse_mass_a, l), P);
  m.w_a = add(m.w_a, multiply(batch.inverse_I_a, l, cross(load(row.f_a, l), P)));
  m.v_b = add_scaled(m.v_b, zero() - load(batch.inverse_mass_b, l), P);
  m.w_b = subtract(m.w_b, multiply(batch.inverse_I_b, l, cross(friction_arm_b(batch, l, row), P)));
}

HWY_INLINE V normal_velocity(std::size_t l, const ContactRow& row, const Motion& m) {
  return dot(load(row.n, l), subtract(m.v_a, m.v_b)) + dot(load(row.j_a, l), m.w_a) -
         dot(load(row.j_b, l), m.w_b);
}

/// Sum of the normal impulses of pairs.
HWY_INLINE V pooled_load(const SoftProblem& problem, const PairBatch& batch, std::size_t l) {
  V sum = zero();
  for (std::uint32_t r = batch.row_begin; r < batch.row_end; ++r)
    sum = sum + load(problem.rows[r].p_n, l);
  return sum;
}

/// What limits the friction of a row.
/// @param pooled  pooled_load(), if any pair of the batch pools
HWY_INLINE V limiting_load(const PairBatch& batch, std::size_t l, const ContactRow& row, V pooled) {
  const V own = load(row.p_n, l);
  if (!batch.pools_any) return own;
  return hn::IfThenElse(hn::Gt(load(batch.pools_load, l), zero()), pooled, own);
}

/// Friction of the lanes in `active`: the exact 2x2 stick solution where that is in the cone. Else
/// a step against the slip, the same along both tangents, then onto the cone: friction must oppose
/// the slip, and the stick solution's direction does not where contacts turn the bodies more easily
/// than they shift them.
template <typename Mask>
HWY_INLINE void solve_friction(const PairBatch& batch, std::size_t l, ContactRow& row, V pooled,
                               const Mask& active, Motion& m) {
  const V3 n = load(row.n, l);
  const V3 t1 = load(row.t, l);
  const V3 t2 = cross(n, t1);
  const V3 slip = subtract(add(m.v_a, cross(m.w_a, load(row.f_a, l))),
                           add(m.v_b, cross(m.w_b, friction_arm_b(batch, l, row))));
  const V s1 = dot(slip, t1);
  const V s2 = dot(slip, t2);
  const V k12 = load(row.k12, l);
  const V old_1 = load(row.p_1, l);
  const V old_2 = load(row.p_2, l);
  const V stick_1 = old_1 - (load(row.k11, l) * s1 + k12 * s2);
  const V stick_2 = old_2 - (k12 * s1 + load(row.k22, l) * s2);
  const V limit = load(row.friction, l) * limiting_load(batch, l, row, pooled);
  const auto slides = hn::Gt(stick_1 * stick_1 + stick_2 * stick_2, limit * limit);
  const V mass = load(row.mass_t, l);
  const V slide_1 = old_1 - mass * s1;
  const V slide_2 = old_2 - mass * s2;
  const V length_squared = slide_1 * slide_1 + slide_2 * slide_2;
  const Tag d;
  const V tiny = hn::Set(d, 1e-30F);
  const V scale = hn::Min(limit / hn::Sqrt(hn::Max(length_squared, tiny)), hn::Set(d, 1.0F));
  const V p_1 = hn::IfThenElse(active, hn::IfThenElse(slides, slide_1 * scale, stick_1), old_1);
  const V p_2 = hn::IfThenElse(active, hn::IfThenElse(slides, slide_2 * scale, stick_2), old_2);
  store(p_1, row.p_1, l);
  store(p_2, row.p_2, l);
  const V d_1 = p_1 - old_1;
  const V d_2 = p_2 - old_2;
  const V3 P = {d_1 * t1.x + d_2 * t2.x, d_1 * t1.y + d_2 * t2.y, d_1 * t1.z + d_2 * t2.z};
  push_friction(batch, l, row, P, m);
}

/// Normal impulse. With a bias, overlap recovers as a damped spring of the batch's softness.
/// @return the impulse
template <bool kBiased>
HWY_INLINE V solve_normal(const PairBatch& batch, std::size_t l, ContactRow& row, V inverse_h,
                          Motion& m) {
  const Tag d;
  const V gap = load(row.gap, l);
  const V old = load(row.p_n, l);
  const V one = hn::Set(d, 1.0F);
  const V room = hn::Max(gap, zero()) * inverse_h;
  V bias = room;
  V mass_scale = one;
  V impulse_scale = zero();
  if constexpr (kBiased) {
    const auto overlaps = hn::Lt(gap, zero());
    const V push = hn::Max(gap * load(batch.bias_rate, l), zero() - load(batch.push_limit, l));
    bias = hn::IfThenElse(overlaps, push, room);
    mass_scale = hn::IfThenElse(overlaps, load(batch.mass_scale, l), one);
    impulse_scale = hn::IfThenElseZero(overlaps, load(batch.impulse_scale, l));
  }
  const V velocity = normal_velocity(l, row, m);
  const V change = load(row.mass_n, l) * mass_scale * (velocity + bias) + impulse_scale * old;
  const V p = hn::Max(old - change, zero());
  store(p, row.p_n, l);
  push_normal(batch, l, row, p - old, m);
  return p;
}

HWY_INLINE RollingBatch& rolling_of(const SoftProblem& problem, const PairBatch& batch) {
  return problem.rolling[&batch - problem.batches];
}

/// Angular impulse on a, its reaction on b.
HWY_INLINE void push_rolling(const PairBatch& batch, std::size_t l, const V3& impulse, Motion& m) {
  m.w_a = add(m.w_a, multiply(batch.inverse_I_a, l, impulse));
  m.w_b = subtract(m.w_b, multiply(batch.inverse_I_b, l, impulse));
}

/// A step against the relative rotation, then into the ball that the load allows. Bounded masses
/// make every step take energy.
/// @param pressed  sum of the normal impulses of pairs
HWY_INLINE void resist_rolling(const PairBatch& batch, std::size_t l, RollingBatch& rolling,
                               V pressed, Motion& m) {
  const Tag d;
  const V3 old = load(rolling.impulse, l);
  const V3 wanted = add_scaled(old, zero() - load(rolling.mass, l), subtract(m.w_a, m.w_b));
  const V limit = load(rolling.arm, l) * pressed;
  const V length_squared = hn::Max(dot(wanted, wanted), hn::Set(d, 1e-30F));
  const V scale = hn::Min(limit / hn::Sqrt(length_squared), hn::Set(d, 1.0F));
  const V3 now = {wanted.x * scale, wanted.y * scale, wanted.z * scale};
  store(now, rolling.impulse, l);
  push_rolling(batch, l, subtract(now, old), m);
}

/// Calls visit(batch, first lane, motion) for every group of lanes in use.
template <typename Visit>
HWY_INLINE void for_each_group(const SoftProblem& problem, std::size_t first, std::size_t count,
                               const Visit& visit) {
  for (std::size_t k = first; k < first + count; ++k) {
    const PairBatch& batch = problem.batches[k];
    for (std::size_t l = 0; l < batch.lanes; l += hn::Lanes(Tag())) {
      Motion m = gather(problem.bodies, batch, l);
      visit(batch, l, m);
    }
  }
}

HWY_INLINE void scatter_pair(const PairBatch& batch, std::size_t l, const Motion& m,
                             SoftBody* bodies) {
  scatter(m.v_a, m.w_a, batch.body_a + l, batch.dynamic_a >> l, bodies);
  scatter(m.v_b, m.w_b, batch.body_b + l, batch.dynamic_b >> l, bodies);
}

/// What friction at a pair's arms does: response to impulses along two tangents.
struct Response {
  V k11, k12, k22;
};

HWY_INLINE Response tangential_response(const PairBatch& batch, std::size_t l,
                                        const ContactRow& row, const V3& t1, const V3& t2) {
  const V3 f_a = load(row.f_a, l);
  const V3 f_b = friction_arm_b(batch, l, row);
  const V3 a1 = cross(f_a, t1), a2 = cross(f_a, t2);
  const V3 b1 = cross(f_b, t1), b2 = cross(f_b, t2);
  const V3 Ia1 = multiply(batch.inverse_I_a, l, a1), Ia2 = multiply(batch.inverse_I_a, l, a2);
  const V3 Ib1 = multiply(batch.inverse_I_b, l, b1), Ib2 = multiply(batch.inverse_I_b, l, b2);
  const V inverse_mass = load(batch.inverse_mass_a, l) + load(batch.inverse_mass_b, l);
  return {inverse_mass + dot(a1, Ia1) + dot(b1, Ib1), dot(a1, Ia2) + dot(b1, Ib2),
          inverse_mass + dot(a2, Ia2) + dot(b2, Ib2)};
}

/// A unit vector across n that turns smoothly with it on each side of the switch.
HWY_INLINE V3 tangent(const V3& n) {
  const Tag d;
  const auto use_x = hn::Lt(hn::Abs(n.x), hn::Set(d, 0.6F));
  const V3 t = {hn::IfThenElse(use_x, zero(), zero() - n.z), hn::IfThenElseZero(use_x, n.z),
                hn::IfThenElse(use_x, zero() - n.y, n.x)};
  const V scale = hn::Set(d, 1.0F) / hn::Sqrt(hn::Max(dot(t, t), hn::Set(d, 1e-30F)));
  return {t.x * scale, t.y * scale, t.z * scale};
}

HWY_INLINE void prepare_row(const PairBatch& batch, std::size_t l, ContactRow& row,
                            const Motion& m) {
  const Tag d;
  const V one = hn::Set(d, 1.0F);
  const V3 n = load(row.n, l);
  const auto used = hn::Gt(dot(n, n), hn::Set(d, 0.5F));
  const V3 arm = load(row.j_a, l);
  const V3 j_a = cross(arm, n);
  const V3 j_b = cross(add(arm, load(batch.offset, l)), n);
  const V3 t1 = tangent(n);
  const V3 t2 = cross(n, t1);
  store(j_a, row.j_a, l);
  store(j_b, row.j_b, l);
  store(t1, row.t, l);
  const V inverse_mass = load(batch.inverse_mass_a, l) + load(batch.inverse_mass_b, l);
  const V k_n = inverse_mass + dot(j_a, multiply(batch.inverse_I_a, l, j_a)) +
                dot(j_b, multiply(batch.inverse_I_b, l, j_b));
  store(hn::IfThenElseZero(used, one / hn::IfThenElse(used, k_n, one)), row.mass_n, l);
  const Response k = tangential_response(batch, l, row, t1, t2);
  const V determinant = hn::IfThenElse(used, k.k11 * k.k22 - k.k12 * k.k12, one);
  store(hn::IfThenElseZero(used, k.k22 / determinant), row.k11, l);
  store(hn::IfThenElseZero(used, zero() - k.k12 / determinant), row.k12, l);
  store(hn::IfThenElseZero(used, k.k11 / determinant), row.k22, l);
  const V mean = hn::Set(d, 0.5F) * (k.k11 + k.k22);
  store(hn::IfThenElseZero(used, one / hn::IfThenElse(used, mean, one)), row.mass_t, l);
  store(normal_velocity(l, row, m), row.approach, l);
  const V3 start = {load(row.p_n, l), load(row.p_1, l), load(row.p_2, l)};
  store(hn::Max(dot(start, n), zero()), row.p_n, l);
  store(dot(start, t1), row.p_1, l);
  store(dot(start, t2), row.p_2, l);
}

void Prepare(const SoftProblem& problem, std::size_t first, std::size_t count) {
  for_each_group(problem, first, count, [&](const PairBatch& batch, std::size_t l, Motion& m) {
    for (std::uint32_t r = batch.row_begin; r < batch.row_end; ++r)
      prepare_row(batch, l, problem.rows[r], m);
  });
}

void WarmStart(const SoftProblem& problem, std::size_t first, std::size_t count) {
  for_each_group(problem, first, count, [&](const PairBatch& batch, std::size_t l, Motion& m) {
    for (std::uint32_t r = batch.row_begin; r < batch.row_end; ++r) {
      const ContactRow& row = problem.rows[r];
      push_normal(batch, l, row, load(row.p_n, l), m);
      const V3 t1 = load(row.t, l);
      const V3 t2 = cross(load(row.n, l), t1);
      const V p_1 = load(row.p_1, l);
      const V p_2 = load(row.p_2, l);
      push_friction(batch, l, row,
                    {p_1 * t1.x + p_2 * t2.x, p_1 * t1.y + p_2 * t2.y, p_1 * t1.z + p_2 * t2.z}, m);
    }
    if (problem.rolling != nullptr)
      push_rolling(batch, l, load(rolling_of(problem, batch).impulse, l), m);
    scatter_pair(batch, l, m, problem.bodies);
  });
}

template <bool kBiased, bool kLast>
HWY_INLINE void sweep(const SoftProblem& problem, std::size_t first, std::size_t count) {
  const Tag d;
  const V inverse_h = hn::Set(d, 1.0F) / hn::Set(d, problem.h);
  const auto everywhere = hn::FirstN(d, kLanes);
  for_each_group(problem, first, count, [&](const PairBatch& batch, std::size_t l, Motion& m) {
    const V pooled = batch.pools_any ? pooled_load(problem, batch, l) : zero();
    for (std::uint32_t r = batch.row_begin; r < batch.row_end; ++r)
      solve_friction(batch, l, problem.rows[r], pooled, everywhere, m);
    V pressed = zero();
    for (std::uint32_t r = batch.row_begin; r < batch.row_end; ++r) {
      ContactRow& row = problem.rows[r];
      pressed = pressed + solve_normal<kBiased>(batch, l, row, inverse_h, m);
      if constexpr (kLast) {
        store(load(row.total_n, l) + load(row.p_n, l), row.total_n, l);
        store(load(row.total_1, l) + load(row.p_1, l), row.total_1, l);
        store(load(row.total_2, l) + load(row.p_2, l), row.total_2, l);
      }
    }
    if (problem.rolling != nullptr)
      resist_rolling(batch, l, rolling_of(problem, batch), pressed, m);
    scatter_pair(batch, l, m, problem.bodies);
  });
}

void AdvanceGaps(const SoftProblem& problem, std::size_t first, std::size_t count) {
  const V step = hn::Set(Tag(), problem.h);
  for_each_group(problem, first, count, [&](const PairBatch& batch, std::size_t l, Motion& m) {
    for (std::uint32_t r = batch.row_begin; r < batch.row_end; ++r) {
      ContactRow& row = problem.rows[r];
      store(load(row.gap, l) + step * normal_velocity(l, row, m), row.gap, l);
    }
  });
}

void Restitution(const SoftProblem& problem, std::size_t first, std::size_t count) {
  const V slow = hn::Set(Tag(), -problem.threshold);
  for_each_group(problem, first, count, [&](const PairBatch& batch, std::size_t l, Motion& m) {
    const V e = load(batch.restitution, l);
    const std::uint32_t count_rows = batch.row_end - batch.row_begin;
    ContactRow* rows = problem.rows;
    const auto bounces = [&](const ContactRow& row) {
      return hn::And(hn::And(hn::Lt(load(row.approach, l), slow), hn::Gt(e, zero())),
                     hn::Gt(load(row.total_n, l), zero()));
    };
    bool any = false;
    for (std::uint32_t k = 0; k < count_rows && !any; ++k)
      any = !hn::AllFalse(Tag(), bounces(rows[batch.row_begin + k]));
    if (!any) return;
    for (int visit = 0; visit < kVisitsPerRestitution; ++visit) {
      for (std::uint32_t k = 0; k < count_rows; ++k) {
        ContactRow& row = rows[batch.row_begin + k];
        const V old = load(row.p_n, l);
        const V velocity = normal_velocity(l, row, m) + e * load(row.approach, l);
        const V p = hn::Max(old - load(row.mass_n, l) * velocity, zero());
        const V change = hn::IfThenElseZero(bounces(row), p - old);
        store(old + change, row.p_n, l);
        store(load(row.total_n, l) + change, row.total_n, l);
        push_normal(batch, l, row, change, m);
      }
      // The impulse that throws bodies apart has its friction, too; normals have the last word.
      if (visit + 1 == kVisitsPerRestitution) break;
      const V pooled = batch.pools_any ? pooled_load(problem, batch, l) : zero();
      for (std::uint32_t k = 0; k < count_rows; ++k) {
        ContactRow& row = rows[batch.row_begin + k];
        const auto bouncing = bounces(row);
        if (hn::AllFalse(Tag(), bouncing)) continue;
        const V old_1 = load(row.p_1, l);
        const V old_2 = load(row.p_2, l);
        solve_friction(batch, l, row, pooled, bouncing, m);
        store(load(row.total_1, l) + (load(row.p_1, l) - old_1), row.total_1, l);
        store(load(row.total_2, l) + (load(row.p_2, l) - old_2), row.total_2, l);
      }
    }
    scatter_pair(batch, l, m, problem.bodies);
  });
}

void Visit(SoftPass pass, const SoftProblem& problem, std::size_t first, std::size_t count) {
  switch (pass) {
    case SoftPass::prepare:
      return Prepare(problem, first, count);
    case SoftPass::warm_start:
      return WarmStart(problem, first, count);
    case SoftPass::biased:
      return sweep<true, false>(problem, first, count);
    case SoftPass::advance_gaps:
      return AdvanceGaps(problem, first, count);
    case SoftPass::relax:
      return sweep<false, false>(problem, first, count);
    case SoftPass::relax_last:
      return sweep<false, true>(problem, first, count);
    case SoftPass::restitution:
      return Restitution(problem, first, count);
  }
}

float Residual(const SoftProblem& problem, std::size_t count) {
  const Tag d;
  const V inverse = hn::Set(d, 1.0F) / hn::Set(d, problem.h);
  V worst = zero();
  for_each_group(problem, 0, count, [&](const PairBatch& batch, std::size_t l, Motion& m) {
    for (std::uint32_t r = batch.row_begin; r < batch.row_end; ++r) {
      const ContactRow& row = problem.rows[r];
      const V mass = load(row.mass_n, l);
      const V w = normal_velocity(l, row, m) + hn::Max(load(row.gap, l), zero()) * inverse;
      const auto used = hn::Gt(mass, zero());
      const V p = load(row.p_n, l) / hn::IfThenElse(used, mass, hn::Set(d, 1.0F));
      worst = hn::Max(worst, hn::IfThenElseZero(used, hn::Abs(hn::Min(p, w))));
    }
  });
  return hn::GetLane(hn::MaxOfLanes(d, worst));
}

}  // namespace HWY_NAMESPACE
}  // namespace gotai::impulse
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace gotai::impulse {

HWY_EXPORT(Visit);
HWY_EXPORT(Residual);

void soft_pass(SoftPass pass, const SoftProblem& problem, std::size_t first, std::size_t count) {
  choose_highway_target();
  HWY_DYNAMIC_DISPATCH(Visit)(pass, problem, first, count);
}
float soft_residual(const SoftProblem& problem, std::size_t count) {
  choose_highway_target();
  return HWY_DYNAMIC_DISPATCH(Residual)(problem, count);
}

}  // namespace gotai::impulse
#endif
