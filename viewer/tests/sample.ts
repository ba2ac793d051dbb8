/** A made-up run: crosses that spin and bounce on a floor, with the data a recording would have. */

import { packNormal, packQuaternion, Quaternion } from "../src/data/quantise";
import { Part, toHalf, writeContainer } from "./encode";

const kRadius = 0.5;

/** Three crossed bars: vertices and triangles. */
function cross(): { vertices: Float32Array; triangles: Uint32Array } {
  const vertices: number[] = [];
  const triangles: number[] = [];
  const bars = [[0.5, 0.14, 0.14], [0.14, 0.5, 0.14], [0.14, 0.14, 0.5]];
  for (const half of bars) {
    const base = vertices.length / 3;
    for (let c = 0; c < 8; ++c)
      for (let k = 0; k < 3; ++k) vertices.push((c >> k) & 1 ? half[k] : -half[k]);
    const quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    for (const [a, b, c, d] of quads) triangles.push(base + a, base + b, base + c, base + a, base + c, base + d);
  }
  return { vertices: new Float32Array(vertices), triangles: new Uint32Array(triangles) };
}

/** Voxels of a level that touch the crossed bars. */
function voxels(level: number): Uint8Array {
  const n = 2 ** (level - 1);
  const out: number[] = [];
  for (let z = 0; z < n; ++z)
    for (let y = 0; y < n; ++y)
      for (let x = 0; x < n; ++x) {
        const p = [x, y, z].map((i) => Math.abs((i + 0.5) / n - 0.5));
        const thin = p.filter((v) => v < 0.14 + 0.5 / n).length;
        if (thin >= 2) out.push(x, y, z);
      }
  return new Uint8Array(out);
}

/** Height and speed of a ball dropped from h over a floor at r, bouncing with e = 0.7. */
export function bounce(h: number, t: number): { z: number; v: number } {
  const g = 9.81;
  let fall = Math.sqrt((2 * (h - kRadius)) / g);
  if (t < fall) return { z: h - 0.5 * g * t * t, v: -g * t };
  t -= fall;
  let v = 0.7 * g * fall;
  while (v > 0.05) {
    fall = (2 * v) / g;
    if (t < fall) return { z: kRadius + v * t - 0.5 * g * t * t, v: v - g * t };
    t -= fall;
    v *= 0.7;
  }
  return { z: kRadius, v: 0 };
}

export interface Sample {
  bytes: Uint8Array;
  poses: Float64Array; // exact: 7 per moving body per frame
  scene: number; // size of the box the bodies stay in [m]
}

/** @param bodies moving ones, on a square grid; body `bodies` is the floor. */
export function sampleRun(bodies: number, frames: number): Sample {
  const side = Math.ceil(Math.sqrt(bodies));
  const exact = new Float64Array(7 * bodies * frames);
  const speed = new Float64Array(bodies * frames);
  const time = Float64Array.from({ length: frames }, (_, f) => f / 60);
  for (let f = 0; f < frames; ++f)
    for (let b = 0; b < bodies; ++b) {
      const { z, v } = bounce(1.5 + ((b * 37) % 50) / 15, time[f]);
      const angle = 0.5 * (0.4 + (b % 5) * 0.4) * time[f];
      const s = Math.sin(angle);
      exact.set([
        1.15 * ((b % side) - (side - 1) / 2), 1.15 * (Math.floor(b / side) - (side - 1) / 2), z,
        Math.cos(angle), s * Math.sin(b), s * Math.cos(b) * 0.6, s * Math.cos(b) * 0.8,
      ], 7 * (f * bodies + b));
      speed[f * bodies + b] = v;
    }
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < exact.length; i += 7)
    for (let k = 0; k < 3; ++k) {
      low[k] = Math.min(low[k], exact[i + k]);
      high[k] = Math.max(high[k], exact[i + k]);
    }
  const step = low.map((v, k) => Math.max(high[k] - v, 1e-9) / 65535);
  const position = new Uint16Array(3 * bodies * frames);
  const orientation = new Uint16Array(3 * bodies * frames);
  const velocity = new Int16Array(3 * bodies * frames);
  const load = new Uint16Array(bodies * frames);
  const offset = [0];
  const touching: { body: number; point: number[]; impulse: number; gap: number }[] = [];
  const velocityStep = 10 / 32767;
  for (let f = 0; f < frames; ++f) {
    for (let b = 0; b < bodies; ++b) {
      const i = 7 * (f * bodies + b);
      const to = 3 * (f * bodies + b);
      for (let k = 0; k < 3; ++k) position[to + k] = Math.round((exact[i + k] - low[k]) / step[k]);
      packQuaternion([...exact.subarray(i + 3, i + 7)] as Quaternion, orientation, to);
      velocity[to + 2] = Math.round(speed[f * bodies + b] / velocityStep);
      const gap = exact[i + 2] - kRadius;
      if (gap > 0.03) continue;
      const impulse = 0.2 + Math.abs(speed[f * bodies + b]);
      load[f * bodies + b] = toHalf(impulse);
      touching.push({ body: b, point: [exact[i], exact[i + 1], 0], impulse, gap });
    }
    offset.push(touching.length);
  }
  const floorStep = step.map((s) => s * 1.3);
  const shape = cross();
  const normal = packNormal([0, 0, 1]);
  const contacts = (name: string): Record<string, Part> => ({
    [`${name}.offset`]: { type: "u32", values: new Uint32Array(offset) },
    [`${name}.body`]: { type: "u16", values: new Uint16Array(touching.flatMap((c) => [c.body, bodies])) },
    [`${name}.point`]: {
      type: "u16",
      values: new Uint16Array(touching.flatMap((c) => c.point.map((x, k) => Math.max(0, (x - (k < 2 ? low[k] : 0)) / floorStep[k])))),
    },
    [`${name}.normal`]: { type: "i16", values: new Int16Array(touching.flatMap(() => normal)) },
    [`${name}.impulse`]: { type: "u16", values: new Uint16Array(touching.flatMap((c) => [0, 0, toHalf(c.impulse)])) },
    [`${name}.gap`]: { type: "u16", values: new Uint16Array(touching.map((c) => toHalf(c.gap))) },
  });
  const sum = (value: (f: number, b: number) => number) =>
    Float32Array.from({ length: frames }, (_, f) => {
      let total = 0;
      for (let b = 0; b < bodies; ++b) total += value(f, b);
      return total;
    });
  const kinetic = sum((f, b) => 0.5 * speed[f * bodies + b] ** 2);
  const potential = sum((f, b) => 9.81 * exact[7 * (f * bodies + b) + 2]);
  const per = (value: (f: number) => number) => Float32Array.from({ length: frames }, (_, f) => value(f));
  const series = {
    kinetic, potential, total: kinetic.map((k, f) => k + potential[f]),
    contacts: per((f) => offset[f + 1] - offset[f]),
    max_overlap: per((f) => 0.4 + 0.2 * Math.sin(f / 9)), residual: per((f) => 1e-10 * (1.5 + Math.sin(f / 5))),
    collision: per((f) => 3 + Math.sin(f / 20)), impulse: per((f) => 2 + Math.cos(f / 14)),
  };
  const header = {
    format: "gotai-view", version: 1, title: "Bouncing crosses", generator: "sample",
    facts: [["Method", "constraint"], ["Contacts", "all"], ["Model", "spheres, level 5"], ["Steps", String(frames)]],
    notes: ["Positions are within 0.04 mm, orientations within 0.004 degrees."],
    gravity: [0, 0, -9.81], level: 4,
    shapes: [{ name: "cross", com: [0, 0, 0], grid: { origin: [-0.5, -0.5, -0.5], edge: 1 }, levels: [1, 2, 3, 4, 5] }],
    materials: [{ name: "plastic", restitution: 0.7, friction: 0.4 }, { name: "floor", restitution: 0.5, friction: 0.8 }],
    bodies: [
      ...Array.from({ length: bodies }, (_, b) => ({
        name: `cross ${b + 1}`, kind: "dynamic", geometry: "shape", shape: 0, material: 0, mass: 1, radius: 0.54,
      })),
      { name: "floor", kind: "fixed", geometry: "plane", shape: 0, material: 1, mass: 0, radius: 0 },
    ],
    frames: { count: frames, position: { origin: low, step }, velocityStep, spinStep: 0.001 },
    contacts: { position: { origin: [low[0], low[1], 0], step: floorStep } },
    apparent: { position: { origin: [low[0], low[1], 0], step: floorStep } },
    series: [
      ...["kinetic", "potential", "total"].map((name) => ({ name, label: name, unit: "J", chart: "Energy" })),
      { name: "contacts", label: "contacts", unit: "", chart: "Contacts" },
      { name: "max_overlap", label: "largest", unit: "mm", chart: "Overlap" },
      { name: "residual", label: "residual", unit: "m/s", chart: "Residual" },
      { name: "collision", label: "collision", unit: "ms", chart: "Time per step" },
      { name: "impulse", label: "impulse", unit: "ms", chart: "Time per step" },
    ],
  };
  const rest = new Float32Array(7 * (bodies + 1));
  for (let b = 0; b <= bodies; ++b) rest[7 * b + 3] = 1;
  const bytes = writeContainer(header, {
    "bodies.pose": { type: "f32", values: rest },
    "frames.time": { type: "f64", values: time },
    "frames.moving": { type: "u32", values: Uint32Array.from({ length: bodies }, (_, b) => b) },
    "frames.position": { type: "u16", values: position, stride: 3 * bodies },
    "frames.orientation": { type: "u16", values: orientation, stride: 3 * bodies },
    "frames.velocity": { type: "i16", values: velocity, stride: 3 * bodies },
    "frames.spin": { type: "i16", values: new Int16Array(3 * bodies * frames), stride: 3 * bodies },
    "frames.load": { type: "u16", values: load },
    ...contacts("contacts"),
    ...contacts("apparent"),
    "shape0.vertices": { type: "f32", values: shape.vertices },
    "shape0.triangles": { type: "u32", values: shape.triangles },
    ...Object.fromEntries([1, 2, 3, 4, 5].map((l) => [`shape0.level${l}`, { type: "u8" as const, values: voxels(l) }])),
    "steps.time": { type: "f64", values: time },
    ...Object.fromEntries(Object.entries(series).map(([n, values]) => [`steps.${n}`, { type: "f32" as const, values }])),
  });
  return { bytes, poses: exact, scene: Math.max(...low.map((v, k) => high[k] - v)) };
}
