// The kernels, compiled once per instruction set and chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "gotai/impulse/soft_kernel.cpp"
#include <hwy/foreach_target.h>
// foreach_target.h must come first.
#include <hwy/highway.h>

#include "gotai/impulse/soft_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace gotai::impulse {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// A pair's velocities are at hand while its batch is visited, so its contacts are swept more than
// once: nearly a block solve, for the price of the arithmetic alone.
constexpr int kVisitsPerSweep = 2;
constexpr int kVisitsPerRestitution = 8;

using Tag = hn::CappedTag<float, kLanes>;
using IndexTag = hn::RebindToSigned<Tag>;
using V = hn::Vec<Tag>;
using Index = hn::Vec<IndexTag>;

struct V3 {
  V x, y, z;
};

HWY_INLINE V load(const Lane& a, std::size_t l) { return hn::Load(Tag(), a.value + l); }
HWY_INLINE V3 load(const Lane3& a, std::size_t l) {
  return {load(a.x, l), load(a.y, l), load(a.z, l)};
}
HWY_INLINE void store(V v, Lane& a, std::size_t l) { hn::Store(v, Tag(), a.value + l); }
HWY_INLINE V zero() { return hn::Zero(Tag()); }

// Written with separate products and sums: fused forms would change bits between instruction sets.
HWY_INLINE V dot(const V3& a, const V3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
HWY_INLINE V3 cross(const V3& a, const V3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
HWY_INLINE V3 add_scaled(const V3& a, V s, const V3& b) {
  return {a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}
HWY_INLINE V3 add(const V3& a, const V3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
HWY_INLINE V3 subtract(const V3& a, const V3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
HWY_INLINE V3 multiply(const LaneInertia& m, std::size_t l, const V3& a) {
  const V xx = load(m.xx, l), xy = load(m.xy, l), xz = load(m.xz, l);
  const V yy = load(m.yy, l), yz = load(m.yz, l), zz = load(m.zz, l);
  return {xx * a.x + xy * a.y + xz * a.z, xy * a.x + yy * a.y + yz * a.z,
          xz * a.x + yz * a.y + zz * a.z};
}

/// Velocities of the pairs in a group of lanes.
struct Motion {
  V3 v_a, w_a, v_b, w_b;
};

HWY_INLINE V3 gather3(const SoftBody* bodies, Index offset, int first) {
  const auto* base = reinterpret_cast<const float*>(bodies);
  const IndexTag d;
  return {hn::GatherIndex(Tag(), base, offset + hn::Set(d, first)),
          hn::GatherIndex(Tag(), base, offset + hn::Set(d, first + 1)),
          hn::GatherIndex(Tag(), base, offset + hn::Set(d, first + 2))};
}

HWY_INLINE Motion gather(const SoftBody* bodies, const PairBatch& batch, std::size_t l) {
  const IndexTag d;
  const Index a = hn::ShiftLeft<3>(hn::LoadU(d, batch.body_a + l));
  const Index b = hn::ShiftLeft<3>(hn::LoadU(d, batch.body_b + l));
  return {gather3(bodies, a, 0), gather3(bodies, a, 3), gather3(bodies, b, 0),
          gather3(bodies, b, 3)};
}

HWY_INLINE void scatter(const V3& v, const V3& w, const std::int32_t* index, std::uint32_t written,
                        SoftBody* bodies) {
  HWY_ALIGN float lanes[6][kLanes];
  const Tag d;
  hn::Store(v.x, d, lanes[0]);
  hn::Store(v.y, d, lanes[1]);
  hn::Store(v.z, d, lanes[2]);
  hn::Store(w.x, d, lanes[3]);
  hn::Store(w.y, d, lanes[4]);
  hn::Store(w.z, d, lanes[5]);
  for (std::size_t k = 0; k < hn::Lanes(d); ++k) {
    if (((written >> k) & 1U) == 0U) continue;
    SoftBody& body = bodies[index[k]];
    for (std::size_t c = 0; c < 3; ++c) {
      body.v[c] = lanes[c][k];
      body.w[c] = lanes[3 + c][k];
    }
  }
}

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

/// Impulse P at the friction point on a, its reaction on b.
HWY_INLINE void push_friction(const PairBatch& batch, std::size_t l, const ContactRow& row,
                              const V3& P, Motion& m) {
  m.v_a = add_scaled(m.v_a, load(batch.inverse_mass_a, l), P);
  m.w_a = add(m.w_a, multiply(batch.inverse_I_a, l, cross(load(row.f_a, l), P)));
  m.v_b = add_scaled(m.v_b, zero() - load(batch.inverse_mass_b, l), P);
  m.w_b = subtract(m.w_b, multiply(batch.inverse_I_b, l, cross(load(row.f_b, l), P)));
}

HWY_INLINE V normal_velocity(std::size_t l, const ContactRow& row, const Motion& m) {
  return dot(load(row.n, l), subtract(m.v_a, m.v_b)) + dot(load(row.j_a, l), m.w_a) -
         dot(load(row.j_b, l), m.w_b);
}

/// Friction of the lanes in `active`: the exact 2x2 stick solution where that is in the cone. Else
/// a step against the slip, the same along both tangents, then onto the cone: friction must oppose
/// the slip, and the stick solution's direction does not where contacts turn the bodies more easily
/// than they shift them.
template <typename Mask>
HWY_INLINE void solve_friction(const PairBatch& batch, std::size_t l, ContactRow& row,
                               const Mask& active, Motion& m) {
  const V3 n = load(row.n, l);
  const V3 t1 = load(row.t, l);
  const V3 t2 = cross(n, t1);
  const V3 slip = subtract(add(m.v_a, cross(m.w_a, load(row.f_a, l))),
                           add(m.v_b, cross(m.w_b, load(row.f_b, l))));
  const V s1 = dot(slip, t1);
  const V s2 = dot(slip, t2);
  const V k12 = load(row.k12, l);
  const V old_1 = load(row.p_1, l);
  const V old_2 = load(row.p_2, l);
  const V stick_1 = old_1 - (load(row.k11, l) * s1 + k12 * s2);
  const V stick_2 = old_2 - (k12 * s1 + load(row.k22, l) * s2);
  const V limit = load(batch.friction, l) * load(row.p_n, l);
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
template <bool kBiased>
HWY_INLINE void solve_normal(const PairBatch& batch, std::size_t l, ContactRow& row, V inverse_h,
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
}

template <typename Visit>
HWY_INLINE void for_each_group(const SoftBody* bodies, const PairBatch* batches, std::size_t count,
                               const Visit& visit) {
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t l = 0; l < kLanes; l += hn::Lanes(Tag())) {
      Motion m = gather(bodies, batches[k], l);
      visit(batches[k], l, m);
    }
}

HWY_INLINE void scatter_pair(const PairBatch& batch, std::size_t l, const Motion& m,
                             SoftBody* bodies) {
  scatter(m.v_a, m.w_a, batch.body_a + l, batch.dynamic_a >> l, bodies);
  scatter(m.v_b, m.w_b, batch.body_b + l, batch.dynamic_b >> l, bodies);
}

void WarmStart(SoftBody* bodies, const PairBatch* batches, std::size_t count,
               const ContactRow* rows) {
  for_each_group(bodies, batches, count, [&](const PairBatch& batch, std::size_t l, Motion& m) {
    for (std::uint32_t r = batch.row_begin; r < batch.row_end; ++r) {
      const ContactRow& row = rows[r];
      push_normal(batch, l, row, load(row.p_n, l), m);
      const V3 t1 = load(row.t, l);
      const V3 t2 = cross(load(row.n, l), t1);
      const V p_1 = load(row.p_1, l);
      const V p_2 = load(row.p_2, l);
      push_friction(batch, l, row,
                    {p_1 * t1.x + p_2 * t2.x, p_1 * t1.y + p_2 * t2.y, p_1 * t1.z + p_2 * t2.z}, m);
    }
    scatter_pair(batch, l, m, bodies);
  });
}

template <bool kBiased>
HWY_INLINE void sweep(SoftBody* bodies, const PairBatch* batches, std::size_t count,
                      ContactRow* rows, float inverse_h) {
  const V inverse = hn::Set(Tag(), inverse_h);
  const auto everywhere = hn::FirstN(Tag(), kLanes);
  for_each_group(bodies, batches, count, [&](const PairBatch& batch, std::size_t l, Motion& m) {
    for (int visit = 0; visit < kVisitsPerSweep; ++visit) {
      for (std::uint32_t r = batch.row_begin; r < batch.row_end; ++r)
        solve_friction(batch, l, rows[r], everywhere, m);
      for (std::uint32_t r = batch.row_begin; r < batch.row_end; ++r)
        solve_normal<kBiased>(batch, l, rows[r], inverse, m);
    }
    scatter_pair(batch, l, m, bodies);
  });
}

void SolveBiased(SoftBody* bodies, const PairBatch* batches, std::size_t count, ContactRow* rows,
                 float inverse_h) {
  sweep<true>(bodies, batches, count, rows, inverse_h);
}

void Relax(SoftBody* bodies, const PairBatch* batches, std::size_t count, ContactRow* rows,
           float inverse_h) {
  sweep<false>(bodies, batches, count, rows, inverse_h);
}

void AdvanceGaps(const SoftBody* bodies, const PairBatch* batches, std::size_t count,
                 ContactRow* rows, float h) {
  const V step = hn::Set(Tag(), h);
  for_each_group(bodies, batches, count, [&](const PairBatch& batch, std::size_t l, Motion& m) {
    for (std::uint32_t r = batch.row_begin; r < batch.row_end; ++r)
      store(load(rows[r].gap, l) + step * normal_velocity(l, rows[r], m), rows[r].gap, l);
  });
}

void Restitution(SoftBody* bodies, const PairBatch* batches, std::size_t count, ContactRow* rows,
                 float threshold) {
  const V slow = hn::Set(Tag(), -threshold);
  for_each_group(bodies, batches, count, [&](const PairBatch& batch, std::size_t l, Motion& m) {
    const V e = load(batch.restitution, l);
    const std::uint32_t count_rows = batch.row_end - batch.row_begin;
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
      for (std::uint32_t k = 0; k < count_rows; ++k) {
        ContactRow& row = rows[batch.row_begin + k];
        const auto bouncing = bounces(row);
        if (hn::AllFalse(Tag(), bouncing)) continue;
        const V old_1 = load(row.p_1, l);
        const V old_2 = load(row.p_2, l);
        solve_friction(batch, l, row, bouncing, m);
        store(load(row.total_1, l) + (load(row.p_1, l) - old_1), row.total_1, l);
        store(load(row.total_2, l) + (load(row.p_2, l) - old_2), row.total_2, l);
      }
    }
    scatter_pair(batch, l, m, bodies);
  });
}

float Residual(const SoftBody* bodies, const PairBatch* batches, std::size_t count,
               const ContactRow* rows, float inverse_h) {
  const Tag d;
  const V inverse = hn::Set(d, inverse_h);
  V worst = zero();
  for_each_group(bodies, batches, count, [&](const PairBatch& batch, std::size_t l, Motion& m) {
    for (std::uint32_t r = batch.row_begin; r < batch.row_end; ++r) {
      const ContactRow& row = rows[r];
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

HWY_EXPORT(WarmStart);
HWY_EXPORT(SolveBiased);
HWY_EXPORT(Relax);
HWY_EXPORT(AdvanceGaps);
HWY_EXPORT(Restitution);
HWY_EXPORT(Residual);

void soft_warm_start(SoftBody* bodies, const PairBatch* batches, std::size_t count,
                     const ContactRow* rows) {
  HWY_DYNAMIC_DISPATCH(WarmStart)(bodies, batches, count, rows);
}
void soft_solve_biased(SoftBody* bodies, const PairBatch* batches, std::size_t count,
                       ContactRow* rows, float inverse_h) {
  HWY_DYNAMIC_DISPATCH(SolveBiased)(bodies, batches, count, rows, inverse_h);
}
void soft_relax(SoftBody* bodies, const PairBatch* batches, std::size_t count, ContactRow* rows,
                float inverse_h) {
  HWY_DYNAMIC_DISPATCH(Relax)(bodies, batches, count, rows, inverse_h);
}
void soft_advance_gaps(const SoftBody* bodies, const PairBatch* batches, std::size_t count,
                       ContactRow* rows, float h) {
  HWY_DYNAMIC_DISPATCH(AdvanceGaps)(bodies, batches, count, rows, h);
}
void soft_restitution(SoftBody* bodies, const PairBatch* batches, std::size_t count,
                      ContactRow* rows, float threshold) {
  HWY_DYNAMIC_DISPATCH(Restitution)(bodies, batches, count, rows, threshold);
}
float soft_residual(const SoftBody* bodies, const PairBatch* batches, std::size_t count,
                    const ContactRow* rows, float inverse_h) {
  return HWY_DYNAMIC_DISPATCH(Residual)(bodies, batches, count, rows, inverse_h);
}

void soft_accumulate(const PairBatch* batches, std::size_t count, ContactRow* rows) {
  for (std::size_t k = 0; k < count; ++k)
    for (std::uint32_t r = batches[k].row_begin; r < batches[k].row_end; ++r)
      for (std::size_t l = 0; l < kLanes; ++l) {
        rows[r].total_n.value[l] += rows[r].p_n.value[l];
        rows[r].total_1.value[l] += rows[r].p_1.value[l];
        rows[r].total_2.value[l] += rows[r].p_2.value[l];
      }
}

}  // namespace gotai::impulse
#endif
