/** What lies on top of the bodies: contacts, apparent contacts, centres of mass. */

import * as THREE from "three";
import { kPose } from "../data/interpolate";
import type { Contacts } from "../data/run";
import { arrowGeometry } from "./geometry";

const kOnTop = { depthTest: false, transparent: true } as const;

/** Instances of one geometry whose number changes from frame to frame. */
class Cloud {
  mesh: THREE.InstancedMesh;

  constructor(
    private readonly parent: THREE.Group,
    private readonly geometry: THREE.BufferGeometry,
    private readonly material: THREE.Material,
    private readonly order: number,
  ) {
    this.mesh = this.make(64);
  }

  begin(count: number): void {
    if (count > this.mesh.instanceMatrix.count) {
      this.parent.remove(this.mesh);
      this.mesh.dispose();
      this.mesh = this.make(Math.ceil(count * 1.5));
    }
    this.mesh.count = count;
  }

  set(i: number, matrix: THREE.Matrix4): void {
    this.mesh.setMatrixAt(i, matrix);
  }

  end(): void {
    this.mesh.instanceMatrix.needsUpdate = true;
  }

  private make(capacity: number): THREE.InstancedMesh {
    const mesh = new THREE.InstancedMesh(this.geometry, this.material, capacity);
    mesh.instanceMatrix.setUsage(THREE.DynamicDrawUsage);
    mesh.frustumCulled = false;
    mesh.renderOrder = this.order;
    mesh.count = 0;
    this.parent.add(mesh);
    return mesh;
  }
}

/** Contact points, their normals, and arrows for their impulses. */
export class ContactMarkers {
  readonly object = new THREE.Group();
  private readonly points: Cloud;
  private readonly arrows: Cloud;
  private readonly normals: THREE.LineSegments;
  private readonly matrix = new THREE.Matrix4();
  private readonly position = new THREE.Vector3();
  private readonly direction = new THREE.Vector3();
  private readonly turn = new THREE.Quaternion();
  private readonly size = new THREE.Vector3();
  private readonly up = new THREE.Vector3(0, 0, 1);

  /**
   * @param length of the arrow for a large impulse [m]
   * @param scales say what is large [N s]; shorter arrows go with the square root
   */
  constructor(
    colour: number, arrowColour: number, private readonly length: number,
    private readonly scales: { impulse: number }, diamond: boolean,
  ) {
    const shape = diamond ? new THREE.OctahedronGeometry(1) : new THREE.SphereGeometry(1, 12, 8);
    this.points = new Cloud(this.object, shape, new THREE.MeshBasicMaterial({ color: colour, ...kOnTop }), 12);
    this.arrows = new Cloud(
      this.object, arrowGeometry(), new THREE.MeshBasicMaterial({ color: arrowColour, ...kOnTop }), 11,
    );
    this.normals = new THREE.LineSegments(
      new THREE.BufferGeometry(),
      new THREE.LineBasicMaterial({ color: colour, ...kOnTop, opacity: 0.8 }),
    );
    this.normals.frustumCulled = false;
    this.normals.renderOrder = 10;
    this.object.add(this.normals);
    this.object.visible = false;
  }

  update(contacts: Contacts, dot: number): void {
    if (!this.object.visible) return;
    const lines = new Float32Array(6 * contacts.count);
    this.points.begin(contacts.count);
    this.arrows.begin(contacts.count);
    for (let i = 0; i < contacts.count; ++i) {
      this.position.fromArray(contacts.point, 3 * i);
      this.matrix.compose(this.position, this.turn.identity(), this.size.setScalar(dot));
      this.points.set(i, this.matrix);
      this.position.toArray(lines, 6 * i);
      this.direction.fromArray(contacts.normal, 3 * i);
      this.direction.multiplyScalar(this.length * 0.35).add(this.position).toArray(lines, 6 * i + 3);
      this.direction.fromArray(contacts.impulse, 3 * i);
      const strength = this.direction.length();
      const length = this.length * Math.min(2.5, Math.sqrt(strength / this.scales.impulse));
      if (strength > 0) this.turn.setFromUnitVectors(this.up, this.direction.divideScalar(strength));
      this.size.setScalar(strength > 0 ? Math.max(length, 1e-9) : 0);
      this.matrix.compose(this.position, this.turn, this.size);
      this.arrows.set(i, this.matrix);
    }
    this.points.end();
    this.arrows.end();
    this.normals.geometry.dispose();
    this.normals.geometry = new THREE.BufferGeometry();
    this.normals.geometry.setAttribute("position", new THREE.BufferAttribute(lines, 3));
  }
}

/** Dots at the centres of mass of the bodies that move. */
export class CentreMarkers {
  readonly object = new THREE.Group();
  private readonly dots: Cloud;
  private readonly matrix = new THREE.Matrix4();

  constructor(private readonly moving: number[]) {
    const material = new THREE.MeshBasicMaterial({ color: 0xff4fa3, ...kOnTop });
    this.dots = new Cloud(this.object, new THREE.SphereGeometry(1, 14, 10), material, 9);
    this.object.visible = false;
  }

  update(poses: Float32Array, present: Uint8Array, dot: number): void {
    if (!this.object.visible) return;
    this.dots.begin(this.moving.length);
    this.moving.forEach((body, i) => {
      const at = kPose * body;
      const size = dot * present[body];
      this.matrix.makeScale(size, size, size).setPosition(poses[at], poses[at + 1], poses[at + 2]);
      this.dots.set(i, this.matrix);
    });
    this.dots.end();
  }
}
