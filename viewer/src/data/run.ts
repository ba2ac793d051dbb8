/** A run as the page sees it: what there is (header) and how it moves (frames). */

import { Container, readContainer } from "./container";
import { kPose } from "./interpolate";
import { Scale, halfToNumber, unpackNormal, unpackQuaternion } from "./quantise";

export interface ShapeHeader {
  name: string;
  com: number[]; // centre of mass in the mesh frame [m]
  grid?: { origin: number[]; edge: number }; // cube of the voxel pyramid, mesh frame [m]
  levels: number[]; // levels of the pyramid that are inside
}

export interface MaterialHeader {
  name: string;
  restitution: number;
  friction: number;
}

export interface BodyHeader {
  name: string;
  kind: "dynamic" | "fixed" | "kinematic";
  geometry: "shape" | "plane" | "container";
  shape: number;
  material: number;
  mass: number; // [kg]; 0 when it does not move
  radius: number; // of the bounding sphere about the centre of mass [m]
  extent?: number[]; // containers: inner half edges x, y and height z [m]
}

export interface SeriesHeader {
  name: string; // array "steps.<name>"
  label: string;
  unit: string;
  chart: string; // series with the same chart share axes
}

export interface RunHeader {
  format: string;
  version: number;
  title: string;
  generator: string;
  live?: boolean;
  facts: [string, string][]; // settings and totals, for people
  notes: string[]; // what was thinned or rounded
  gravity: number[];
  shapes: ShapeHeader[];
  materials: MaterialHeader[];
  bodies: BodyHeader[];
  level: number; // the level the run collided at
  frames?: { count: number; position: Scale; velocityStep: number; spinStep: number };
  contacts?: { position: Scale };
  apparent?: { position: Scale };
  series: SeriesHeader[];
}

/** The contacts of one frame. */
export interface Contacts {
  count: number;
  body: Uint32Array; // 2 per contact: a, b
  point: Float32Array; // [m], 3 per contact
  normal: Float32Array; // from b to a, 3 per contact
  impulse: Float32Array; // on a [N s], 3 per contact
  gap: Float32Array; // [m]
}

export const kNoContacts: Contacts = {
  count: 0,
  body: new Uint32Array(),
  point: new Float32Array(),
  normal: new Float32Array(),
  impulse: new Float32Array(),
  gap: new Float32Array(),
};

/** Where frames come from: a recording inside the page, or a running simulation. */
export interface Frames {
  readonly count: number;
  readonly times: ArrayLike<number>;
  /** Poses of all bodies: centre of mass [m] and orientation (w, x, y, z), kPose per body. */
  poses(frame: number, out: Float32Array): void;
  /** Velocity [m/s] and angular velocity [rad/s] of all bodies, 6 per body. */
  velocities(frame: number, out: Float32Array): void;
  /**
   * Sum of the contact impulses on each body in the step that ended here [N s]. Not a number for a
   * body that is not there: added later, or removed.
   */
  loads(frame: number, out: Float32Array): void;
  contacts(frame: number): Contacts;
  apparent(frame: number): Contacts;
}

/** Measurements per step, for the charts. */
export interface Series {
  time: number[];
  values: Map<string, number[]>;
}

export interface Mesh {
  positions: Float32Array; // mesh frame [m]
  triangles: Uint32Array;
}

export interface Voxels {
  level: number;
  edge: number; // [m]
  centers: Float32Array; // mesh frame [m]
}

/** Everything about a run. */
export interface Run {
  header: RunHeader;
  meshes: Mesh[];
  voxels: Map<number, Voxels>[]; // per shape, by level
  frames: Frames;
  series: Series;
}

function readMesh(file: Container<RunHeader>, shape: number): Mesh {
  return {
    positions: file.array(`shape${shape}.vertices`) as Float32Array,
    triangles: file.array(`shape${shape}.triangles`) as Uint32Array,
  };
}

function readVoxels(file: Container<RunHeader>, shape: number): Map<number, Voxels> {
  const header = file.header.shapes[shape];
  const levels = new Map<number, Voxels>();
  if (!header.grid) return levels;
  for (const level of header.levels) {
    const index = file.array(`shape${shape}.level${level}`);
    const edge = header.grid.edge / 2 ** (level - 1);
    const centers = new Float32Array(index.length);
    for (let i = 0; i < index.length; ++i)
      centers[i] = header.grid.origin[i % 3] + (index[i] + 0.5) * edge;
    levels.set(level, { level, edge, centers });
  }
  return levels;
}

/** Contacts of all frames, packed. */
class PackedContacts {
  private readonly offset: Uint32Array;
  private readonly body: ArrayLike<number>;
  private readonly point: ArrayLike<number>;
  private readonly normal: Int16Array;
  private readonly impulse: Uint16Array;
  private readonly gap: Uint16Array;

  constructor(file: Container<RunHeader>, name: string, private readonly scale: Scale) {
    this.offset = file.array(`${name}.offset`) as Uint32Array;
    this.body = file.array(`${name}.body`);
    this.point = file.array(`${name}.point`);
    this.normal = file.array(`${name}.normal`) as Int16Array;
    this.impulse = file.array(`${name}.impulse`) as Uint16Array;
    this.gap = file.array(`${name}.gap`) as Uint16Array;
  }

  at(frame: number): Contacts {
    const begin = this.offset[frame];
    const count = this.offset[frame + 1] - begin;
    const out: Contacts = {
      count,
      body: new Uint32Array(2 * count),
      point: new Float32Array(3 * count),
      normal: new Float32Array(3 * count),
      impulse: new Float32Array(3 * count),
      gap: new Float32Array(count),
    };
    for (let i = 0; i < count; ++i) {
      const from = begin + i;
      out.body[2 * i] = this.body[2 * from];
      out.body[2 * i + 1] = this.body[2 * from + 1];
      out.normal.set(unpackNormal(this.normal[2 * from], this.normal[2 * from + 1]), 3 * i);
      for (let k = 0; k < 3; ++k) {
        out.point[3 * i + k] = this.scale.origin[k] + this.scale.step[k] * this.point[3 * from + k];
        out.impulse[3 * i + k] = halfToNumber(this.impulse[3 * from + k]);
      }
      out.gap[i] = halfToNumber(this.gap[from]);
    }
    return out;
  }
}

/** Frames of a recording that lies in the page. */
class PackedFrames implements Frames {
  readonly count: number;
  readonly times: Float64Array;
  private readonly moving: Uint32Array;
  private readonly rest: Float32Array; // poses of bodies that never move
  private readonly position: ArrayLike<number>;
  private readonly orientation: Uint16Array;
  private readonly velocity: Int16Array;
  private readonly spin: Int16Array;
  private readonly load: Uint16Array;
  private readonly allContacts?: PackedContacts;
  private readonly allApparent?: PackedContacts;

  constructor(private readonly header: RunHeader, file: Container<RunHeader>) {
    this.count = header.frames!.count;
    this.times = file.array("frames.time") as Float64Array;
    this.moving = file.array("frames.moving") as Uint32Array;
    this.rest = file.array("bodies.pose") as Float32Array;
    this.position = file.array("frames.position");
    this.orientation = file.array("frames.orientation") as Uint16Array;
    this.velocity = file.array("frames.velocity") as Int16Array;
    this.spin = file.array("frames.spin") as Int16Array;
    this.load = file.array("frames.load") as Uint16Array;
    if (header.contacts) this.allContacts = new PackedContacts(file, "contacts", header.contacts.position);
    if (header.apparent) this.allApparent = new PackedContacts(file, "apparent", header.apparent.position);
  }

  poses(frame: number, out: Float32Array): void {
    const { origin, step } = this.header.frames!.position;
    out.set(this.rest);
    for (let j = 0; j < this.moving.length; ++j) {
      const to = kPose * this.moving[j];
      const from = 3 * (frame * this.moving.length + j);
      for (let k = 0; k < 3; ++k) out[to + k] = origin[k] + step[k] * this.position[from + k];
      unpackQuaternion(this.orientation, from, out, to + 3);
    }
  }

  velocities(frame: number, out: Float32Array): void {
    const { velocityStep, spinStep } = this.header.frames!;
    out.fill(0);
    for (let j = 0; j < this.moving.length; ++j) {
      const to = 6 * this.moving[j];
      const from = 3 * (frame * this.moving.length + j);
      for (let k = 0; k < 3; ++k) {
        out[to + k] = velocityStep * this.velocity[from + k];
        out[to + 3 + k] = spinStep * this.spin[from + k];
      }
    }
  }

  loads(frame: number, out: Float32Array): void {
    out.fill(0);
    for (let j = 0; j < this.moving.length; ++j)
      out[this.moving[j]] = halfToNumber(this.load[frame * this.moving.length + j]);
  }

  contacts(frame: number): Contacts {
    return this.allContacts?.at(frame) ?? kNoContacts;
  }

  apparent(frame: number): Contacts {
    return this.allApparent?.at(frame) ?? kNoContacts;
  }
}

function readSeries(file: Container<RunHeader>): Series {
  const series: Series = { time: [], values: new Map() };
  if (file.has("steps.time")) series.time = Array.from(file.array("steps.time"));
  for (const { name } of file.header.series)
    series.values.set(name, file.has(`steps.${name}`) ? Array.from(file.array(`steps.${name}`)) : []);
  return series;
}

/** Reads a run. `frames` replaces the recorded frames for a live run. */
export function readRun(bytes: Uint8Array, frames?: Frames): Run {
  const file = readContainer<RunHeader>(bytes);
  const header = file.header;
  if (header.format !== "gotai-view" || header.version !== 1)
    throw new Error(`cannot show data of version ${header.version}`);
  return {
    header,
    meshes: header.shapes.map((_, i) => readMesh(file, i)),
    voxels: header.shapes.map((_, i) => readVoxels(file, i)),
    frames: frames ?? new PackedFrames(header, file),
    series: readSeries(file),
  };
}
