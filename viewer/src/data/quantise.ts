/** How numbers are packed: positions, orientations, normals and half floats. */

export type Vector = [number, number, number];
export type Quaternion = [number, number, number, number]; // w, x, y, z

/** Coordinate of a packed position: origin + step * value. */
export interface Scale {
  origin: number[];
  step: number[];
}

export const kHalfRange = Math.SQRT1_2; // no smallest-three component exceeds 1/sqrt(2)
const kWord = 32767; // the lower 15 bits
const kQuatMax = 32766; // even, so that zero is exact

/**
 * A unit quaternion from its three smallest components: 15 bits each, and the index of the largest
 * component in the top bits of the first two words. Writes w, x, y, z.
 */
export function unpackQuaternion(
  words: Uint16Array, at: number, out: Float32Array | Float64Array, to: number,
): void {
  const largest = ((words[at] >> 15) << 1) | (words[at + 1] >> 15);
  let sum = 0;
  let k = 0;
  for (let i = 0; i < 4; ++i) {
    if (i === largest) continue;
    const value = (((words[at + k] & kWord) / kQuatMax) * 2 - 1) * kHalfRange;
    out[to + i] = value;
    sum += value * value;
    ++k;
  }
  out[to + largest] = Math.sqrt(Math.max(0, 1 - sum));
}

/** The inverse of unpackQuaternion; `q` need not be normalised. */
export function packQuaternion(q: Quaternion, words: Uint16Array, at: number): void {
  const norm = Math.hypot(...q);
  let largest = 0;
  for (let i = 1; i < 4; ++i) if (Math.abs(q[i]) > Math.abs(q[largest])) largest = i;
  const sign = q[largest] < 0 ? -1 : 1;
  let k = 0;
  for (let i = 0; i < 4; ++i) {
    if (i === largest) continue;
    const unit = ((sign * q[i]) / norm / kHalfRange + 1) / 2;
    words[at + k++] = Math.round(Math.min(1, Math.max(0, unit)) * kQuatMax);
  }
  words[at] |= (largest >> 1) << 15;
  words[at + 1] |= (largest & 1) << 15;
}

/** A unit vector from two octahedral coordinates in [-32767, 32767]. */
export function unpackNormal(u: number, v: number): Vector {
  let x = u / 32767;
  let y = v / 32767;
  const z = 1 - Math.abs(x) - Math.abs(y);
  if (z < 0) {
    const fold = x;
    x = (1 - Math.abs(y)) * (fold < 0 ? -1 : 1);
    y = (1 - Math.abs(fold)) * (y < 0 ? -1 : 1);
  }
  const length = Math.hypot(x, y, z);
  return [x / length, y / length, z / length];
}

/** The inverse of unpackNormal. */
export function packNormal(n: Vector): [number, number] {
  const sum = Math.abs(n[0]) + Math.abs(n[1]) + Math.abs(n[2]);
  let x = n[0] / sum;
  let y = n[1] / sum;
  if (n[2] < 0) {
    const fold = x;
    x = (1 - Math.abs(y)) * (fold < 0 ? -1 : 1);
    y = (1 - Math.abs(fold)) * (y < 0 ? -1 : 1);
  }
  return [Math.round(x * 32767), Math.round(y * 32767)];
}

/** The number in an IEEE 754 half-precision word. */
export function halfToNumber(half: number): number {
  const sign = half & 0x8000 ? -1 : 1;
  const exponent = (half >> 10) & 31;
  const fraction = half & 1023;
  if (exponent === 0) return sign * fraction * 2 ** -24;
  if (exponent === 31) return fraction ? NaN : sign * Infinity;
  return sign * (1 + fraction / 1024) * 2 ** (exponent - 15);
}
