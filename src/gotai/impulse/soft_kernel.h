/// @file
/// Sixteen-lane kernels of the sub-stepped solver: plain single-precision arrays in, plain arrays
/// out.
///
/// Sixteen pairs that share no dynamic body make a batch; lane l of every row belongs to pair l.
/// Single precision is enough because the kernels only compute changes of velocities, which the
/// double state accumulates. The same bits come out on every instruction set: no fused
/// multiply-add, no approximate reciprocals, lanes never mixed.
#pragma once

#include <cstddef>
#include <cstdint>

namespace gotai::impulse {

inline constexpr std::size_t kLanes = 16;

/// One number per lane.
struct alignas(64) Lane {
  float value[kLanes] = {};
};
struct Lane3 {
  Lane x, y, z;
};

/// Velocities of one body, half a cache line. Written by the kernels.
struct alignas(32) SoftBody {
  float v[3] = {};  ///< [m/s], W
  float unused_v = 0.0F;
  float w[3] = {};  ///< [rad/s], W
  float unused_w = 0.0F;
};

/// Symmetric 3x3 matrix per lane: xx, xy, xz, yy, yz, zz.
struct LaneInertia {
  Lane xx, xy, xz, yy, yz, zz;
};

/// Sixteen pairs. Padding lanes have body indices 0, inverse masses 0 and no contacts.
struct PairBatch {
  std::uint32_t body_a[kLanes] = {};  ///< index into the body array
  std::uint32_t body_b[kLanes] = {};
  std::uint32_t dynamic_a = 0;  ///< bit l: body a of lane l is dynamic (is written)
  std::uint32_t dynamic_b = 0;
  std::uint32_t row_begin = 0;  ///< into the row array
  std::uint32_t row_end = 0;
  std::uint32_t lanes = 0;               ///< lanes in use
  bool pools_any = false;                ///< some lane has pools_load
  Lane3 offset;                          ///< centre of mass of a minus that of b [m], W
  Lane inverse_mass_a, inverse_mass_b;   ///< [1/kg]
  LaneInertia inverse_I_a, inverse_I_b;  ///< [1/(kg m^2)], W
  Lane restitution;
  Lane bias_rate;      ///< share of the overlap that is recovered per second [1/s]
  Lane mass_scale;     ///< softness of the constraint, in (0, 1]
  Lane impulse_scale;  ///< its memory loss, in [0, 1)
  Lane push_limit;     ///< largest recovery speed [m/s]
  /// 1: the pair slides on shares of a patch, whose friction depends on all that presses the pair.
  Lane pools_load;
};

/// One contact of each of the pairs of a batch. Missing contacts have n = 0.
struct ContactRow {
  Lane3 n;             ///< normal, b -> a
  Lane3 j_a;           ///< given: arm of the contact on a [m]; from prepare on: arm x normal
  Lane3 j_b;           ///< arm on b x normal [m]; written by prepare
  Lane3 t;             ///< first tangent, the second is n x t; written by prepare
  Lane3 f_a;           ///< arm of the friction force on a [m]
  Lane friction;       ///< its limit as a fraction of p_n, or of all p_n of a pair that pools them
  Lane gap;            ///< [m]; changed by advance_gaps
  Lane mass_n;         ///< 1 / (n . K n) [kg], 0 for missing contacts; written by prepare
  Lane k11, k12, k22;  ///< inverse of the 2x2 tangential K [kg]; written by prepare
  Lane mass_t;         ///< 1 / mean of K's diagonal [kg]; written by prepare
  /// Given: impulse to start with, W. From prepare on: impulses of the present sub-step along n, t
  /// and n x t, the state of the sweeps [N s].
  Lane p_n, p_1, p_2;
  Lane total_n, total_1, total_2;  ///< summed over the sub-steps [N s]
  Lane approach;                   ///< normal velocity before the step [m/s]; written by prepare
};

/// Resistance of the pairs of a batch to rolling and spinning on each other: an impulse against
/// their relative angular velocity, of at most `arm` times all that presses the pair. Padding lanes
/// are 0.
struct RollingBatch {
  Lane arm;       ///< [m]
  Lane mass;      ///< 1 / (a bound of what an angular impulse changes) [kg m^2]
  Lane3 impulse;  ///< of the present sub-step, on a [N m s], W: the state of the sweeps
};

/// What a visit to all batches does.
enum class SoftPass : std::uint8_t {
  prepare,       ///< fills what ContactRow says, once per step
  warm_start,    ///< applies the impulses of the last sub-step
  biased,        ///< one sweep with overlap recovery
  advance_gaps,  ///< gap += h * normal velocity
  relax,         ///< one sweep that only stops approach beyond the gap
  relax_last,    ///< the same, and adds the impulses of the sub-step to the totals
  restitution,   ///< towards -e times the approach velocity, where that was faster than threshold
};

/// What the passes work on.
struct SoftProblem {
  SoftBody* bodies = nullptr;
  const PairBatch* batches = nullptr;
  ContactRow* rows = nullptr;
  RollingBatch* rolling = nullptr;  ///< one per batch; null: nothing resists rolling
  float h = 0.0F;                   ///< sub-step [s]
  float threshold = 0.0F;           ///< of restitution [m/s]
};

/// Visits batches [first, first + count) in order.
void soft_pass(SoftPass pass, const SoftProblem& problem, std::size_t first, std::size_t count);

/// Largest natural-map residual |min(p_n / mass_n, v_n + max(gap, 0) / h)| of all batches [m/s].
float soft_residual(const SoftProblem& problem, std::size_t count);

}  // namespace gotai::impulse
