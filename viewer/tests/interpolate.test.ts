import { describe, expect, it } from "vitest";
import { locate, mixPoses, slerp } from "../src/data/interpolate";

/** Quaternion of a turn by an angle [rad] about a unit axis. */
const turn = (angle: number, [x, y, z]: number[]) => {
  const s = Math.sin(angle / 2);
  return [Math.cos(angle / 2), s * x, s * y, s * z];
};

describe("slerp", () => {
  const axis = [2 / 3, -1 / 3, 2 / 3];

  it("turns evenly about a fixed axis", () => {
    for (const angle of [1e-6, 1e-3, 0.02, 0.3, 1.5, 3.1])
      for (const f of [0, 0.1, 0.5, 0.77, 1]) {
        const out = [0, 0, 0, 0];
        slerp(turn(0.4, axis), 0, turn(0.4 + angle, axis), 0, f, out, 0);
        turn(0.4 + f * angle, axis).forEach((value, k) => expect(out[k]).toBeCloseTo(value, 7));
      }
  });

  it("takes the shorter way when the signs differ", () => {
    const out = [0, 0, 0, 0];
    slerp(turn(0.2, axis), 0, turn(0.6, axis).map((v) => -v), 0, 0.5, out, 0);
    turn(0.4, axis).forEach((value, k) => expect(out[k]).toBeCloseTo(value, 12));
  });

  it("gives unit quaternions", () => {
    const out = [0, 0, 0, 0];
    for (let i = 0; i < 50; ++i) {
      slerp(turn(i, [1, 0, 0]), 0, turn(3 * i, [0, 0.6, 0.8]), 0, i / 50, out, 0);
      expect(Math.hypot(...out)).toBeCloseTo(1, 12);
    }
  });
});

describe("locate", () => {
  const times = [0, 0.1, 0.3, 0.6];
  it("finds frame and fraction", () => {
    expect(locate(times, 0.2)).toEqual({ index: 1, fraction: expect.closeTo(0.5, 12) });
    expect(locate(times, 0.3)).toEqual({ index: 2, fraction: 0 });
  });
  it("holds at both ends, and for no or one frame", () => {
    expect(locate(times, -1)).toEqual({ index: 0, fraction: 0 });
    expect(locate(times, 9)).toEqual({ index: 3, fraction: 0 });
    expect(locate([], 1)).toEqual({ index: 0, fraction: 0 });
    expect(locate([2], 3)).toEqual({ index: 0, fraction: 0 });
    expect(locate(times, NaN)).toEqual({ index: 0, fraction: 0 });
  });
});

describe("mixPoses", () => {
  it("may write over its first argument", () => {
    const a = Float32Array.from([0, 0, 0, ...turn(0, [0, 0, 1]), 1, 1, 1, ...turn(0.2, [1, 0, 0])]);
    const b = Float32Array.from([2, 4, 6, ...turn(1, [0, 0, 1]), 3, 1, 1, ...turn(0.6, [1, 0, 0])]);
    mixPoses(a, b, 0.25, a);
    expect([...a.subarray(0, 3)]).toEqual([0.5, 1, 1.5]);
    turn(0.25, [0, 0, 1]).forEach((value, k) => expect(a[3 + k]).toBeCloseTo(value, 6));
    expect(a[7]).toBe(1.5);
    turn(0.3, [1, 0, 0]).forEach((value, k) => expect(a[10 + k]).toBeCloseTo(value, 6));
  });
});
