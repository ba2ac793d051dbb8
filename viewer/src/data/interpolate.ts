/** Poses between recorded frames. */

/** Index i and fraction f in [0, 1) with times[i] <= t; clamped to the ends. */
export function locate(times: ArrayLike<number>, t: number): { index: number; fraction: number } {
  const last = times.length - 1;
  if (last <= 0 || !(t > times[0])) return { index: 0, fraction: 0 };
  if (t >= times[last]) return { index: last, fraction: 0 };
  let low = 0;
  let high = last;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle;
    else high = middle;
  }
  const span = times[high] - times[low];
  return { index: low, fraction: span > 0 ? (t - times[low]) / span : 0 };
}

/**
 * Spherical interpolation of unit quaternions along the shorter arc, exact at both ends.
 * Reads four components of a and b at their offsets and writes four into out.
 */
export function slerp(
  a: ArrayLike<number>, ai: number, b: ArrayLike<number>, bi: number, f: number,
  out: Float32Array | Float64Array | number[], oi: number,
): void {
  let dot = a[ai] * b[bi] + a[ai + 1] * b[bi + 1] + a[ai + 2] * b[bi + 2] + a[ai + 3] * b[bi + 3];
  const sign = dot < 0 ? -1 : 1;
  dot = Math.min(1, Math.abs(dot));
  let wa = 1 - f;
  let wb = f;
  if (dot < 0.9995) {
    const angle = Math.acos(dot);
    const s = Math.sin(angle);
    wa = Math.sin((1 - f) * angle) / s;
    wb = Math.sin(f * angle) / s;
  }
  wb *= sign;
  let norm = 0;
  for (let k = 0; k < 4; ++k) {
    const value = wa * a[ai + k] + wb * b[bi + k];
    out[oi + k] = value;
    norm += value * value;
  }
  norm = 1 / Math.sqrt(norm);
  for (let k = 0; k < 4; ++k) out[oi + k] *= norm;
}

/** Numbers of one body's pose: x, y, z [m], then w, x, y, z. */
export const kPose = 7;

/** Poses between two frames: positions linearly, orientations by slerp. */
export function mixPoses(a: Float32Array, b: Float32Array, f: number, out: Float32Array): void {
  for (let i = 0; i < out.length; i += kPose) {
    for (let k = i; k < i + 3; ++k) out[k] = a[k] + (b[k] - a[k]) * f;
    slerp(a, i + 3, b, i + 3, f, out, i + 3);
  }
}
