import { describe, expect, it } from "vitest";
import { fromBase64, inflate, readContainer } from "../src/data/container";
import { halfToNumber, packNormal, packQuaternion, Quaternion, unpackNormal, unpackQuaternion, Vector } from "../src/data/quantise";
import { LiveFrames, takeMessage } from "../src/data/live";
import { readRun } from "../src/data/run";
import { toHalf, toText, writeContainer } from "./encode";
import { sampleRun } from "./sample";

/** Repeatable numbers in [-1, 1). */
function randoms(seed: number): () => number {
  return () => {
    seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0;
    return seed / 2 ** 31 - 1;
  };
}

describe("packed quaternions", () => {
  it("lose less than 1.5e-4 rad, and nothing at rest", () => {
    const random = randoms(7);
    const words = new Uint16Array(3);
    const out = new Float64Array(4);
    let worst = 0;
    const special: Quaternion[] = [[1, 0, 0, 0], [0, -1, 0, 0], [0.5, 0.5, -0.5, 0.5], [0, 0, 0, -1]];
    for (let i = 0; i < 20000; ++i) {
      const q = special[i] ?? ([random(), random(), random(), random()] as Quaternion);
      const norm = Math.hypot(...q);
      words.fill(0);
      packQuaternion(q, words, 0);
      unpackQuaternion(words, 0, out, 0);
      expect(Math.hypot(...out)).toBeCloseTo(1, 12);
      const unit = q.map((v) => v / norm);
      const sign = Math.sign(unit.reduce((sum, v, k) => sum + v * out[k], 0));
      // The chord is exact for small angles, where 1 - |dot| loses its digits.
      worst = Math.max(worst, 2 * Math.hypot(...unit.map((v, k) => v - sign * out[k])));
    }
    expect(worst).toBeLessThan(1.5e-4);
    packQuaternion([1, 0, 0, 0], words.fill(0), 0);
    unpackQuaternion(words, 0, out, 0);
    expect([...out]).toEqual([1, 0, 0, 0]);
  });
});

describe("packed normals", () => {
  it("lose less than 1e-4 rad", () => {
    const random = randoms(3);
    for (let i = 0; i < 5000; ++i) {
      const n = [random(), random(), random()] as Vector;
      const length = Math.hypot(...n);
      const unit = n.map((v) => v / length) as Vector;
      const back = unpackNormal(...packNormal(unit));
      expect(Math.hypot(...unit.map((v, k) => v - back[k]))).toBeLessThan(1e-4);
    }
    expect(unpackNormal(...packNormal([0, 0, -1]))).toEqual([0, 0, -1].map((v) => expect.closeTo(v, 9)));
  });
});

describe("half floats", () => {
  it("read known words", () => {
    const known: [number, number][] = [[0x3c00, 1], [0xc000, -2], [0x7bff, 65504], [0x0001, 2 ** -24], [0x0400, 2 ** -14], [0, 0], [0x3555, 0.333251953125]];
    for (const [word, value] of known) expect(halfToNumber(word)).toBe(value);
    expect(halfToNumber(0x7c00)).toBe(Infinity);
    expect(halfToNumber(0x7e00)).toBeNaN();
  });
  it("come back from every finite word", () => {
    for (let word = 0; word < 0x7c00; ++word) expect(toHalf(halfToNumber(word))).toBe(word);
  });
});

describe("containers", () => {
  it("sum differences up, across overflow", () => {
    const values = new Uint16Array([65000, 3, 10, 65535, 0, 7]);
    const file = readContainer<{ a: number }>(writeContainer({ a: 1 }, { x: { type: "u16", values, stride: 2 } }));
    expect(file.header).toEqual({ a: 1 });
    expect([...file.array("x")]).toEqual([...values]);
    expect(() => file.array("y")).toThrow(/no array "y"/);
  });
  it("say what is wrong with bad bytes", () => {
    const good = writeContainer({}, { x: { type: "f64", values: new Float64Array([1, 2]) } });
    expect(() => readContainer(new Uint8Array([1, 2, 3]))).toThrow(/not the data/);
    expect(() => readContainer(good.slice(0, 12))).toThrow(/cut off/);
    expect(() => readContainer(good.slice(0, -8)).array("x")).toThrow(/does not fit/);
  });
});

describe("a run", () => {
  const sample = sampleRun(30, 100);

  it("comes back with every point of a body within 1e-4 of the scene's size", async () => {
    const run = readRun(await inflate(fromBase64(toText(sample.bytes))));
    const poses = new Float32Array(7 * 31);
    let distance = 0;
    let angle = 0;
    for (let f = 0; f < run.frames.count; ++f) {
      run.frames.poses(f, poses);
      for (let b = 0; b < 30; ++b) {
        const exact = sample.poses.subarray(7 * (f * 30 + b), 7 * (f * 30 + b) + 7);
        const norm = Math.hypot(...exact.subarray(3));
        for (let k = 0; k < 3; ++k) distance = Math.max(distance, Math.abs(poses[7 * b + k] - exact[k]));
        const sign = Math.sign([3, 4, 5, 6].reduce((sum, k) => sum + exact[k] * poses[7 * b + k], 0));
        const off = [3, 4, 5, 6].map((k) => exact[k] / norm - sign * poses[7 * b + k]);
        angle = Math.max(angle, 2 * Math.hypot(...off));
      }
    }
    expect(distance).toBeGreaterThan(0);
    expect(angle).toBeLessThan(1.5e-4);
    const radius = run.header.bodies[0].radius;
    expect((Math.sqrt(3) * distance + angle * radius) / sample.scene).toBeLessThan(1e-4);
  });

  it("has contacts, voxels and measurements", () => {
    const run = readRun(sample.bytes);
    const frame = [...Array(100).keys()].find((f) => run.frames.contacts(f).count > 0)!;
    const contacts = run.frames.contacts(frame);
    expect([...contacts.normal.subarray(0, 3)]).toEqual([0, 0, 1]);
    expect(contacts.body[1]).toBe(30);
    expect(contacts.impulse[2]).toBeGreaterThan(0.19);
    const loads = new Float32Array(31);
    run.frames.loads(frame, loads);
    expect(loads[contacts.body[0]]).toBe(contacts.impulse[2]);
    expect(run.voxels[0].get(1)!.centers).toEqual(new Float32Array([0, 0, 0]));
    expect(run.series.time.length).toBe(100);
    expect(run.series.values.get("total")!.length).toBe(100);
  });

  it("of another version is refused", () => {
    expect(() => readRun(writeContainer({ format: "gotai-view", version: 2, shapes: [] }, {}))).toThrow(/version 2/);
  });
});

describe("live messages", () => {
  it("add frames and measurements, and forget the oldest", () => {
    const frames = new LiveFrames();
    const series = { time: [] as number[], values: new Map([["kinetic", [] as number[]]]) };
    const send = (time: number) => {
      const f32 = (values: number[]) => ({ type: "f32" as const, values: new Float32Array(values) });
      const bytes = writeContainer(
        { time, bodies: 1, steps: [{ time, kinetic: 2 * time }] },
        {
          pose: f32([time, 0, 0, 1, 0, 0, 0]), velocity: f32([1, 0, 0, 0, 0, 0]), load: f32([0]),
          "contacts.body": { type: "u32", values: new Uint32Array([0, 1]) },
          "contacts.point": f32([1, 2, 3]), "contacts.normal": f32([0, 0, 1]),
          "contacts.impulse": f32([0, 0, 4]), "contacts.gap": f32([-0.5]),
        },
      );
      takeMessage(Buffer.from(bytes).toString("base64"), frames, series);
    };
    send(0);
    send(0.5);
    const poses = new Float32Array(7);
    frames.poses(1, poses);
    expect([...poses]).toEqual([0.5, 0, 0, 1, 0, 0, 0]);
    expect(frames.contacts(1)).toMatchObject({ count: 1, gap: new Float32Array([-0.5]) });
    expect(frames.apparent(1).count).toBe(0);
    expect(series.time).toEqual([0, 0.5]);
    expect(series.values.get("kinetic")).toEqual([0, 1]);
    for (let i = 0; i < 3700; ++i) send(1 + i);
    expect(frames.count).toBe(3600);
    expect(frames.times[0]).toBe(101);
  });
});
