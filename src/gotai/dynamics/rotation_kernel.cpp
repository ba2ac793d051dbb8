// The kernel, compiled once per instruction set and chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "gotai/dynamics/rotation_kernel.cpp"
#include <hwy/foreach_target.h>
// foreach_target.h must come first.
#include <hwy/highway.h>

#include <array>

#include "gotai/core/highway_target.h"
#include "gotai/dynamics/rotation.h"
#include "gotai/dynamics/rotation_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace gotai::dynamics {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<double, kRotationLanes>;
using V = hn::Vec<Tag>;
using Row = RotationLanes::Row;

struct V3 {
  V x, y, z;
};
struct Q {
  V x, y, z, w;
};

HWY_INLINE V number(double value) { return hn::Set(Tag(), value); }
HWY_INLINE V load(const Row& row, std::size_t l) { return hn::Load(Tag(), row.lane + l); }
HWY_INLINE void store(V v, Row& row, std::size_t l) { hn::Store(v, Tag(), row.lane + l); }
HWY_INLINE V3 load3(const Row* rows, std::size_t l) {
  return {load(rows[0], l), load(rows[1], l), load(rows[2], l)};
}
HWY_INLINE Q load4(const Row* rows, std::size_t l) {
  return {load(rows[0], l), load(rows[1], l), load(rows[2], l), load(rows[3], l)};
}

// Sums in the order of Eigen's, so that a body rotates to the same bits here and there.
HWY_INLINE V dot(const V3& a, const V3& b) { return a.x * b.x + (a.y * b.y + a.z * b.z); }
HWY_INLINE V3 cross(const V3& a, const V3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
HWY_INLINE V3 scaled(V s, const V3& a) { return {s * a.x, s * a.y, s * a.z}; }
HWY_INLINE Q multiply(const Q& a, const Q& b) {
  return {(a.w * b.x + a.y * b.z) - (a.z * b.y - a.x * b.w),
          (a.w * b.y + a.y * b.w) + (a.z * b.x - a.x * b.z),
          (a.w * b.z - a.y * b.x) + (a.z * b.w + a.x * b.y),
          (a.w * b.w - a.y * b.y) - (a.z * b.z + a.x * b.x)};
}
HWY_INLINE Q conjugate(const Q& q) { return {hn::Neg(q.x), hn::Neg(q.y), hn::Neg(q.z), q.w}; }
HWY_INLINE V3 rotate(const Q& q, const V3& a) {
  const V3 axis = {q.x, q.y, q.z};
  const V3 half = cross(axis, a);
  const V3 uv = {half.x + half.x, half.y + half.y, half.z + half.z};
  const V3 end = cross(axis, uv);
  return {a.x + q.w * uv.x + end.x, a.y + q.w * uv.y + end.y, a.z + q.w * uv.z + end.z};
}
HWY_INLINE Q normalized(const Q& q) {
  const V length = hn::Sqrt((q.x * q.x + q.z * q.z) + (q.y * q.y + q.w * q.w));
  return {q.x / length, q.y / length, q.z / length, q.w / length};
}

struct Turn {
  V cosine, sinc;
};

HWY_INLINE V series(V y, const std::array<double, 5>& c) {
  const V one = number(1.0);
  V sum = one;
  for (std::size_t k = c.size(); k-- > 0;) sum = one - y * number(c[k]) * sum;
  return sum;
}

/// The same as for one angle.
HWY_INLINE Turn cosine_and_sinc(V squared) {
  if (hn::AllTrue(Tag(), hn::Le(squared, number(kLargestInSeries))))
    return {series(squared, kCosineSeries), series(squared, kSincSeries)};
  HWY_ALIGN double angle[kRotationLanes], cosine[kRotationLanes], sinc[kRotationLanes];
  hn::Store(squared, Tag(), angle);
  for (std::size_t l = 0; l < hn::Lanes(Tag()); ++l) {
    const CosineAndSinc exact = dynamics::cosine_and_sinc(angle[l]);
    cosine[l] = exact.cosine;
    sinc[l] = exact.sinc;
  }
  return {hn::Load(Tag(), cosine), hn::Load(Tag(), sinc)};
}

/// Turns about a principal axis, with the coordinates across it in positive order.
/// @param axis, next, last  of turn and L, in P
HWY_INLINE void turn_about(V rate, V time, V& turn, V& turn_next, V& turn_last, V& turn_w, V L_axis,
                           V& L_next, V& L_last) {
  const V half_angle = number(0.5) * time * rate * L_axis;
  const auto [c, sinc] = cosine_and_sinc(half_angle * half_angle);
  const V s = half_angle * sinc;
  const V w = turn_w, v = turn, v_next = turn_next, v_last = turn_last, before = L_next;
  turn_w = w * c - v * s;
  turn = w * s + v * c;
  turn_next = v_next * c + v_last * s;
  turn_last = v_last * c - v_next * s;
  const V cosine = c * c - s * s;
  const V sine = number(2.0) * c * s;
  L_next = cosine * before + sine * L_last;
  L_last = cosine * L_last - sine * before;
}

/// @param q        orientation of P in W
/// @param inverse  of the principal moments
HWY_INLINE void write_derived(RotationLanes& b, std::size_t l, const Q& q, const V3& inverse,
                              const V3& L_W) {
  const V two = number(2.0);
  const V one = number(1.0);
  const V tx = two * q.x, ty = two * q.y, tz = two * q.z;
  const V twx = tx * q.w, twy = ty * q.w, twz = tz * q.w;
  const V txx = tx * q.x, txy = ty * q.x, txz = tz * q.x;
  const V tyy = ty * q.y, tyz = tz * q.y, tzz = tz * q.z;
  const V3 row[3] = {{one - (tyy + tzz), txy - twz, txz + twy},
                     {txy + twz, one - (txx + tzz), tyz - twx},
                     {txz - twy, tyz + twx, one - (txx + tyy)}};
  V entry[6];
  std::size_t k = 0;
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t r = c; r < 3; ++r)
      entry[k++] = row[r].x * inverse.x * row[c].x + row[r].y * inverse.y * row[c].y +
                   row[r].z * inverse.z * row[c].z;
  for (k = 0; k < 6; ++k) store(entry[k], b.inverse_I_W[k], l);
  store(dot({entry[0], entry[1], entry[2]}, L_W), b.w_W[0], l);
  store(dot({entry[1], entry[3], entry[4]}, L_W), b.w_W[1], l);
  store(dot({entry[2], entry[4], entry[5]}, L_W), b.w_W[2], l);
}

void RotateFree(RotationLanes& b, double dt) {
  const V one = number(1.0);
  for (std::size_t l = 0; l < kRotationLanes; l += hn::Lanes(Tag())) {
    const V3 moments = load3(b.principal_moments, l);
    const V3 inverse = {one / moments.x, one / moments.y, one / moments.z};
    const Q q_BP = load4(b.q_BP, l);
    const V3 L_W = load3(b.L_W, l);
    const Q q_WP = multiply(load4(b.q_WB, l), q_BP);
    V3 L_P = rotate(conjugate(q_WP), L_W);
    Q turn_P = {number(0.0), number(0.0), number(0.0), one};
    const V rate_x = inverse.x - inverse.y;
    const V rate_z = inverse.z - inverse.y;
    const auto turn_x = [&](double time) HWY_ATTR {
      turn_about(rate_x, number(time), turn_P.x, turn_P.y, turn_P.z, turn_P.w, L_P.x, L_P.y, L_P.z);
    };
    turn_x(0.5 * dt);
    turn_about(rate_z, number(dt), turn_P.z, turn_P.x, turn_P.y, turn_P.w, L_P.z, L_P.x, L_P.y);
    turn_x(0.5 * dt);
    const V3 w_W = scaled(inverse.y, L_W);
    const auto [cosine, sinc] = cosine_and_sinc(number(0.25 * dt * dt) * dot(w_W, w_W));
    const V3 axis = scaled(number(0.5 * dt) * sinc, w_W);
    const Q sphere = {axis.x, axis.y, axis.z, cosine};
    const Q q_WB = normalized(multiply(multiply(sphere, multiply(q_WP, turn_P)), conjugate(q_BP)));
    store(q_WB.x, b.q_WB[0], l);
    store(q_WB.y, b.q_WB[1], l);
    store(q_WB.z, b.q_WB[2], l);
    store(q_WB.w, b.q_WB[3], l);
    write_derived(b, l, multiply(q_WB, q_BP), inverse, L_W);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace gotai::dynamics
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace gotai::dynamics {

HWY_EXPORT(RotateFree);

void rotate_free(RotationLanes& bodies, double dt) {
  choose_highway_target();
  HWY_DYNAMIC_DISPATCH(RotateFree)(bodies, dt);
}

}  // namespace gotai::dynamics
#endif
