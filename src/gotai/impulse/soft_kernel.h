/// @file
/// Eight-lane kernels of the sub-stepped solver: plain single-precision arrays in, plain arrays
/// out.
///
/// Eight pairs that share no dynamic body make a batch; lane l of every row belongs to pair l.
/// Single precision is enough because the kernels only compute changes of velocities, which the
/// double state accumulates. The same bits come out on every instruction set: no fused
/// multiply-add, no approximate reciprocals, lanes never mixed.
#pragma once

#include <cstddef>
#include <cstdint>

namespace gotai::impulse {

inline constexpr std::size_t kLanes = 8;

/// One number per lane.
struct alignas(32) Lane {
  float value[kLanes] = {};
};
struct Lane3 {
  Lane x, y, z;
};

/// Velocities of one body, one cache-line half. Written by the kernels.
struct alignas(32) SoftBody {
  float v[3] = {};  ///< [m/s], W
  float w[3] = {};  ///< [rad/s], W
  float unused[2] = {};
};

/// Symmetric 3x3 matrix per lane: xx, xy, xz, yy, yz, zz.
struct LaneInertia {
  Lane xx, xy, xz, yy, yz, zz;
};

/// Eight pairs. Padding lanes have body indices 0, inverse masses 0 and no contacts.
struct PairBatch {
  std::int32_t body_a[kLanes] = {};  ///< index into the body array
  std::int32_t body_b[kLanes] = {};
  std::uint32_t dynamic_a = 0;  ///< bit l: body a of lane l is dynamic (is written)
  std::uint32_t dynamic_b = 0;
  std::uint32_t row_begin = 0;  ///< into the row array
  std::uint32_t row_end = 0;
  Lane inverse_mass_a, inverse_mass_b;   ///< [1/kg]
  LaneInertia inverse_I_a, inverse_I_b;  ///< [1/(kg m^2)], W
  Lane friction;
  Lane restitution;
  Lane bias_rate;      ///< share of the overlap that is recovered per second [1/s]
  Lane mass_scale;     ///< softness of the constraint, in (0, 1]
  Lane impulse_scale;  ///< its memory loss, in [0, 1)
  Lane push_limit;     ///< largest recovery speed [m/s]
};

/// One contact of each of the eight pairs of a batch. Missing contacts have mass_n = 0.
struct ContactRow {
  Lane3 n;                         ///< normal, b -> a
  Lane3 j_a, j_b;                  ///< arm x normal [m]
  Lane3 t;                         ///< first tangent; the second is n x t
  Lane3 f_a, f_b;                  ///< arms of the friction force [m]
  Lane gap;                        ///< [m]; written by advance_gaps
  Lane mass_n;                     ///< 1 / (n . K n) [kg]
  Lane k11, k12, k22;              ///< inverse of the 2x2 tangential K [kg]
  Lane mass_t;                     ///< 1 / mean of K's diagonal [kg]
  Lane p_n, p_1, p_2;              ///< impulses of the present sub-step [N s]; state of the sweeps
  Lane total_n, total_1, total_2;  ///< summed over the sub-steps [N s]
  Lane approach;                   ///< normal velocity before the step [m/s]
};

/// Applies the impulses of the last sub-step.
void soft_warm_start(SoftBody* bodies, const PairBatch* batches, std::size_t count,
                     const ContactRow* rows);
/// One sweep with overlap recovery. @param inverse_h  1 / sub-step [1/s]
void soft_solve_biased(SoftBody* bodies, const PairBatch* batches, std::size_t count,
                       ContactRow* rows, float inverse_h);
/// One sweep that only stops approach beyond the gap.
void soft_relax(SoftBody* bodies, const PairBatch* batches, std::size_t count, ContactRow* rows,
                float inverse_h);
/// gap += h * normal velocity.
void soft_advance_gaps(const SoftBody* bodies, const PairBatch* batches, std::size_t count,
                       ContactRow* rows, float h);
/// total += impulses of the sub-step.
void soft_accumulate(const PairBatch* batches, std::size_t count, ContactRow* rows);
/// One sweep towards -e times the approach velocity, where that was faster than the threshold
/// [m/s].
void soft_restitution(SoftBody* bodies, const PairBatch* batches, std::size_t count,
                      ContactRow* rows, float threshold);
/// Largest natural-map residual |min(p_n / mass_n, v_n + max(gap, 0) / h)| [m/s].
float soft_residual(const SoftBody* bodies, const PairBatch* batches, std::size_t count,
                    const ContactRow* rows, float inverse_h);

}  // namespace gotai::impulse
