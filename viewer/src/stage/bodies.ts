/** The bodies: one instanced mesh per shape. */

import * as THREE from "three";
import { kPose } from "../data/interpolate";
import type { Run } from "../data/run";
import { creasedGeometry } from "./geometry";

interface Group {
  mesh: THREE.InstancedMesh;
  bodies: number[];
}

export class Bodies {
  readonly object = new THREE.Group();
  private readonly groups: Group[] = [];
  private readonly material = new THREE.MeshStandardMaterial({ roughness: 0.55, metalness: 0.02 });
  private readonly glow: THREE.Mesh;
  private readonly matrix = new THREE.Matrix4();
  private readonly quaternion = new THREE.Quaternion();
  private readonly position = new THREE.Vector3();
  private readonly size = new THREE.Vector3();

  constructor(run: Run) {
    run.header.shapes.forEach((shape, index) => {
      const bodies: number[] = [];
      run.header.bodies.forEach((body, i) => {
        if (body.geometry === "shape" && body.shape === index) bodies.push(i);
      });
      if (!bodies.length) return;
      // Drawn about the centre of mass, which is where a body's pose is.
      const geometry = creasedGeometry(run.meshes[index]);
      geometry.translate(-shape.com[0], -shape.com[1], -shape.com[2]);
      const mesh = new THREE.InstancedMesh(geometry, this.material, bodies.length);
      mesh.instanceMatrix.setUsage(THREE.DynamicDrawUsage);
      mesh.castShadow = true;
      mesh.receiveShadow = true;
      mesh.frustumCulled = false;
      bodies.forEach((_, i) => mesh.setColorAt(i, new THREE.Color(1, 1, 1)));
      this.groups.push({ mesh, bodies });
      this.object.add(mesh);
    });
    this.glow = new THREE.Mesh(
      undefined,
      new THREE.MeshBasicMaterial({
        color: 0xffffff, transparent: true, opacity: 0.32, depthWrite: false,
        polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -2,
      }),
    );
    this.glow.matrixAutoUpdate = false;
    this.glow.visible = false;
    this.object.add(this.glow);
  }

  setTranslucent(on: boolean): void {
    this.material.transparent = on;
    this.material.opacity = on ? 0.22 : 1;
    this.material.depthWrite = !on;
    this.material.needsUpdate = true;
  }

  setVisible(on: boolean): void {
    for (const { mesh } of this.groups) mesh.visible = on;
  }

  update(
    poses: Float32Array, present: Uint8Array, colours: Float32Array, selected: number, accent: number,
  ): void {
    const colour = new THREE.Color();
    this.glow.visible = false;
    for (const { mesh, bodies } of this.groups) {
      bodies.forEach((body, i) => {
        this.compose(poses, body, present[body]);
        mesh.setMatrixAt(i, this.matrix);
        mesh.setColorAt(i, colour.fromArray(colours, 3 * body));
        if (body !== selected) return;
        this.glow.geometry = mesh.geometry;
        this.glow.matrix.copy(this.matrix);
        this.glow.visible = mesh.visible;
        (this.glow.material as THREE.MeshBasicMaterial).color.set(accent).offsetHSL(0, 0, 0.15);
      });
      mesh.instanceMatrix.needsUpdate = true;
      mesh.instanceColor!.needsUpdate = true;
      mesh.boundingSphere = null; // it bounds all instances, which have moved
    }
  }

  /** Index of the body under a ray, or -1. */
  pick(ray: THREE.Raycaster): number {
    let best = Infinity;
    let picked = -1;
    for (const { mesh, bodies } of this.groups)
      for (const hit of ray.intersectObject(mesh, false))
        if (hit.distance < best) {
          best = hit.distance;
          picked = bodies[hit.instanceId!];
        }
    return picked;
  }

  private compose(poses: Float32Array, body: number, scale: number): void {
    const i = kPose * body;
    this.position.fromArray(poses, i);
    this.quaternion.set(poses[i + 4], poses[i + 5], poses[i + 6], poses[i + 3]);
    this.matrix.compose(this.position, this.quaternion, this.size.setScalar(scale));
  }
}
