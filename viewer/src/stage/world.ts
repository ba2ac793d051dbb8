/** The run as a scene: brings bodies, walls and markers to a moment of time. */

import * as THREE from "three";
import { kPose, locate, mixPoses } from "../data/interpolate";
import type { Contacts, Run } from "../data/run";
import type { Options } from "../options";
import { Bodies } from "./bodies";
import { ColourMode, kFixedColour, kMaterialColours, indexColour, kThemes, rampColour } from "./colours";
import { CentreMarkers, ContactMarkers } from "./markers";
import { Trails } from "./trails";
import { VoxelSpheres } from "./voxels";
import { Walls } from "./walls";

/** The value that is drawn hottest, per colour mode. */
export interface ColourScales {
  speed: number; // [m/s]
  impulse: number; // [N s]
}

const percentile = (values: number[], part: number) => {
  values.sort((a, b) => a - b);
  return values.length ? values[Math.min(values.length - 1, Math.floor(part * values.length))] : 0;
};

export class World {
  readonly object = new THREE.Group();
  readonly moving: number[];
  readonly scales: ColourScales;
  readonly box: THREE.Box3; // of the whole run
  readonly extent: THREE.Sphere; // around it
  /** State of the shown moment. */
  readonly poses: Float32Array;
  readonly velocities: Float32Array;
  readonly loads: Float32Array;
  readonly present: Uint8Array; // 1 for bodies that are there
  contacts!: Contacts;
  frame = 0;
  private readonly next: Float32Array;
  private readonly colours: Float32Array;
  private readonly bodies: Bodies;
  private readonly walls: Walls;
  private readonly spheres: VoxelSpheres;
  private readonly contactMarkers: ContactMarkers;
  private readonly apparentMarkers: ContactMarkers;
  private readonly centres: CentreMarkers;
  private readonly trails: Trails;
  private readonly bodyRadius: number;
  private loaded = -1;

  /** @param simple  draws with less detail, for machines without a graphics card */
  constructor(private readonly run: Run, simple: boolean) {
    const bodies = run.header.bodies;
    this.moving = bodies.flatMap((body, i) => (body.kind !== "fixed" ? [i] : []));
    this.poses = new Float32Array(kPose * bodies.length);
    this.next = new Float32Array(kPose * bodies.length);
    this.velocities = new Float32Array(6 * bodies.length);
    this.loads = new Float32Array(bodies.length);
    this.present = new Uint8Array(bodies.length).fill(1);
    this.colours = new Float32Array(3 * bodies.length);
    this.box = this.measureBox();
    this.extent = this.box.getBoundingSphere(new THREE.Sphere());
    this.bodyRadius = percentile(this.moving.map((b) => bodies[b].radius), 0.5) || this.extent.radius / 10;
    this.scales = this.measureScales();

    this.bodies = new Bodies(run);
    this.walls = new Walls(run, this.extent, this.firstPoses());
    this.spheres = new VoxelSpheres(run, simple);
    this.contactMarkers = new ContactMarkers(0xff3d3d, 0xffb000, 0.9 * this.bodyRadius, this.scales, false);
    this.apparentMarkers = new ContactMarkers(0x00c2d8, 0x0a7fe0, 0.9 * this.bodyRadius, this.scales, true);
    this.centres = new CentreMarkers(this.moving);
    this.trails = new Trails(run.frames, this.moving, bodies.length);
    this.object.add(
      this.walls.object, this.bodies.object, this.spheres.object, this.trails.object, this.centres.object,
      this.contactMarkers.object, this.apparentMarkers.object,
    );
  }

  /** Applies what the reader of the page chose. Returns a remark on the voxel spheres. */
  apply(options: Options): string {
    const theme = kThemes[options.theme];
    this.walls.setTheme(theme);
    this.walls.object.visible = options.walls;
    this.bodies.setTranslucent(options.translucent);
    this.bodies.setVisible(!options.voxels);
    this.spheres.object.visible = options.voxels;
    this.contactMarkers.object.visible = options.contacts;
    this.apparentMarkers.object.visible = options.apparent;
    this.centres.object.visible = options.centres;
    this.trails.object.visible = options.trails;
    return options.voxels ? this.spheres.show(options.level, options.selected) : "";
  }

  /** Brings everything to a time. */
  show(time: number, options: Options): void {
    const { frames } = this.run;
    if (!frames.count) return;
    const { index, fraction } = locate(frames.times, time);
    this.frame = index;
    frames.poses(index, this.poses);
    if (fraction > 0) {
      frames.poses(index + 1, this.next);
      mixPoses(this.poses, this.next, fraction, this.poses);
    }
    // Contacts and velocities belong to recorded moments: show those of the nearest one.
    const nearest = fraction > 0.5 ? index + 1 : index;
    if (nearest !== this.loaded || this.run.header.live) {
      frames.velocities(nearest, this.velocities);
      frames.loads(nearest, this.loads);
      this.loads.forEach((load, b) => (this.present[b] = Number.isNaN(load) ? 0 : 1));
      this.contacts = frames.contacts(nearest);
      this.loaded = nearest;
      if (this.run.header.live) this.growScales();
    }
    const dot = 0.05 * this.bodyRadius;
    this.paint(options.colour);
    this.bodies.update(this.poses, this.present, this.colours, options.selected, kThemes[options.theme].accent);
    this.walls.update(this.poses);
    this.spheres.update(this.poses, this.present, this.colours);
    this.contactMarkers.update(this.contacts, dot);
    this.apparentMarkers.update(frames.apparent(nearest), 1.7 * dot);
    this.centres.update(this.poses, this.present, 1.4 * dot);
    this.trails.update(index, this.poses, this.present, this.colours);
  }

  pick(ray: THREE.Raycaster): number {
    return this.bodies.pick(ray);
  }

  /** Box around a body at the shown moment, or around all that moves and the containers. */
  boxOf(body: number): THREE.Box3 {
    if (body < 0) return this.box;
    const center = new THREE.Vector3().fromArray(this.poses, kPose * body);
    const size = new THREE.Vector3().setScalar(3 * this.run.header.bodies[body].radius);
    return new THREE.Box3().setFromCenterAndSize(center, size);
  }

  private paint(mode: ColourMode): void {
    const colour = new THREE.Color();
    this.run.header.bodies.forEach((body, i) => {
      if (!this.present[i]) return;
      if (body.kind === "fixed" && mode !== "material") colour.copy(kFixedColour);
      else if (mode === "material") colour.set(kMaterialColours[body.material % kMaterialColours.length]);
      else if (mode === "index") indexColour(i, colour);
      else if (mode === "speed") rampColour(this.speed(i) / this.scales.speed, colour);
      else rampColour(Math.sqrt(this.loads[i] / this.scales.impulse), colour);
      colour.toArray(this.colours, 3 * i);
    });
  }

  speed(body: number): number {
    const i = 6 * body;
    return Math.hypot(this.velocities[i], this.velocities[i + 1], this.velocities[i + 2]);
  }

  private firstPoses(): Float32Array {
    const poses = new Float32Array(this.poses.length);
    if (this.run.frames.count) this.run.frames.poses(0, poses);
    return poses;
  }

  private sampledFrames(): number[] {
    const count = this.run.frames.count;
    const samples = Math.min(24, count);
    return Array.from({ length: samples }, (_, k) => Math.round((k * (count - 1)) / Math.max(1, samples - 1)));
  }

  /** Around where bodies spend the run; the few that fly off do not count. */
  private measureBox(): THREE.Box3 {
    const axes: number[][] = [[], [], []];
    const poses = new Float32Array(this.poses.length);
    const bodies = this.run.header.bodies;
    for (const frame of this.sampledFrames()) {
      this.run.frames.poses(frame, poses);
      this.run.frames.loads(frame, this.loads);
      for (const body of this.moving.filter((b) => !Number.isNaN(this.loads[b])))
        for (let k = 0; k < 3; ++k) {
          const at = poses[kPose * body + k];
          axes[k].push(at - bodies[body].radius, at + bodies[body].radius);
        }
    }
    const box = new THREE.Box3();
    if (axes[0].length) {
      box.min.fromArray(axes.map((axis) => percentile(axis, 0.01)));
      box.max.fromArray(axes.map((axis) => percentile(axis, 0.99)));
    }
    const first = this.firstPoses();
    const moves = new Set(this.moving);
    bodies.forEach((body, i) => {
      if (body.geometry === "plane" || moves.has(i)) return;
      const at = new THREE.Vector3().fromArray(first, kPose * i);
      const [x, y, z] = body.extent ?? [body.radius, body.radius, body.radius];
      box.expandByPoint(at.clone().add(new THREE.Vector3(x, y, z)));
      box.expandByPoint(at.clone().sub(new THREE.Vector3(x, y, body.extent ? 0 : z)));
    });
    if (this.run.header.live) this.addGround(box);
    return box.isEmpty() ? new THREE.Box3().setFromCenterAndSize(new THREE.Vector3(), new THREE.Vector3(1, 1, 1)) : box;
  }

  /** Nobody knows yet where a running simulation goes; most fall onto their planes. */
  private addGround(box: THREE.Box3): void {
    if (box.isEmpty()) return;
    const poses = this.firstPoses();
    const center = box.getCenter(new THREE.Vector3());
    this.run.header.bodies.forEach((body, i) => {
      if (body.geometry !== "plane") return;
      const at = kPose * i;
      const turn = new THREE.Quaternion(poses[at + 4], poses[at + 5], poses[at + 6], poses[at + 3]);
      const normal = new THREE.Vector3(0, 0, 1).applyQuaternion(turn);
      const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(normal, new THREE.Vector3().fromArray(poses, at));
      box.expandByPoint(plane.projectPoint(center, new THREE.Vector3()));
    });
  }

  /** While a simulation runs, the scales grow with what it shows. */
  private growScales(): void {
    for (const body of this.moving) {
      this.scales.speed = Math.max(this.scales.speed, this.speed(body));
      if (this.loads[body] > this.scales.impulse) this.scales.impulse = this.loads[body];
    }
  }

  private measureScales(): ColourScales {
    const speeds: number[] = [];
    const loads: number[] = [];
    for (const frame of this.sampledFrames()) {
      this.run.frames.velocities(frame, this.velocities);
      this.run.frames.loads(frame, this.loads);
      for (const body of this.moving) {
        speeds.push(this.speed(body));
        if (this.loads[body] > 0) loads.push(this.loads[body]);
      }
    }
    return { speed: percentile(speeds, 0.98) || 1, impulse: percentile(loads, 0.98) || 1 };
  }
}
