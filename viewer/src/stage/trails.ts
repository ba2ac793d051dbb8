/** The paths that centres of mass have taken, fading into the past. */

import * as THREE from "three";
import { kPose } from "../data/interpolate";
import type { Frames } from "../data/run";

const kPoints = 48; // per trail
const kMostTrails = 400;

export class Trails {
  readonly object: THREE.LineSegments;
  private readonly positions: THREE.BufferAttribute;
  private readonly colours: THREE.BufferAttribute;
  private readonly bodies: number[];
  private history: Float32Array[] = []; // poses of the last frames, newest first
  private newest = -1;

  /** @param bodyCount all bodies of the run; trails are drawn of at most 400 moving ones. */
  constructor(private readonly frames: Frames, moving: number[], private readonly bodyCount: number) {
    const skip = Math.ceil(moving.length / kMostTrails);
    this.bodies = moving.filter((_, i) => i % skip === 0);
    const vertices = this.bodies.length * kPoints * 2;
    const geometry = new THREE.BufferGeometry();
    this.positions = new THREE.BufferAttribute(new Float32Array(3 * vertices), 3);
    this.colours = new THREE.BufferAttribute(new Float32Array(4 * vertices), 4);
    geometry.setAttribute("position", this.positions);
    geometry.setAttribute("color", this.colours);
    const material = new THREE.LineBasicMaterial({ vertexColors: true, transparent: true, depthWrite: false });
    this.object = new THREE.LineSegments(geometry, material);
    this.object.frustumCulled = false;
    this.object.visible = false;
  }

  /** @param frame the frame at or before the present moment; `poses` are those of the moment. */
  update(frame: number, poses: Float32Array, present: Uint8Array, bodyColours: Float32Array): void {
    if (!this.object.visible) return;
    this.remember(frame);
    let at = 0;
    for (const body of this.bodies) {
      let from = poses;
      for (let k = 0; k < kPoints; ++k) {
        const to = this.history[Math.min(k, this.history.length - 1)];
        this.vertex(at++, from, body, bodyColours, present[body] * (1 - k / kPoints));
        this.vertex(at++, to, body, bodyColours, present[body] * (1 - (k + 1) / kPoints));
        from = to;
      }
    }
    this.positions.needsUpdate = true;
    this.colours.needsUpdate = true;
  }

  private vertex(i: number, poses: Float32Array, body: number, colours: Float32Array, alpha: number): void {
    const p = kPose * body;
    this.positions.setXYZ(i, poses[p], poses[p + 1], poses[p + 2]);
    this.colours.setXYZW(i, colours[3 * body], colours[3 * body + 1], colours[3 * body + 2], alpha);
  }

  private remember(frame: number): void {
    if (frame === this.newest && this.history.length) return;
    const follows = frame === this.newest + 1;
    const count = Math.min(kPoints, frame + 1);
    const next: Float32Array[] = [];
    for (let k = 0; k < count; ++k) {
      const known = follows && k > 0 ? this.history[k - 1] : undefined;
      const poses = known ?? new Float32Array(kPose * this.bodyCount);
      if (!known) this.frames.poses(frame - k, poses);
      next.push(poses);
    }
    this.history = next;
    this.newest = frame;
  }
}
