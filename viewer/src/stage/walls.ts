/** Planes and containers. */

import * as THREE from "three";
import { kPose } from "../data/interpolate";
import type { BodyHeader, Run } from "../data/run";
import { Theme } from "./colours";

const kGridShader = {
  vertexShader: /* glsl */ `
    varying vec2 at;
    void main() {
      at = position.xy;
      gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
    }`,
  fragmentShader: /* glsl */ `
    uniform vec3 ground, line;
    uniform float cell, radius;
    varying vec2 at;
    float grid(float size) {
      vec2 x = at / size;
      vec2 width = max(fwidth(x), 1e-6);
      vec2 near = abs(fract(x - 0.5) - 0.5) / width;
      float fade = clamp(1.0 - 2.5 * max(width.x, width.y), 0.0, 1.0);
      return (1.0 - min(min(near.x, near.y), 1.0)) * fade;
    }
    void main() {
      float far = length(at) / radius;
      float ink = max(0.35 * grid(cell), 0.8 * grid(5.0 * cell));
      float alpha = 1.0 - smoothstep(0.25, 1.0, far);
      gl_FragColor = vec4(mix(ground, line, ink), alpha);
      #include <colorspace_fragment>
    }`,
};

/** A length of 1, 2 or 5 times a power of ten near the given one. */
export function roundLength(length: number): number {
  const power = 10 ** Math.floor(Math.log10(length));
  const lead = length / power;
  return power * (lead < 1.5 ? 1 : lead < 3.5 ? 2 : lead < 7.5 ? 5 : 10);
}

function frameOf(poses: Float32Array, body: number): { at: THREE.Vector3; up: THREE.Vector3 } {
  const i = kPose * body;
  const turn = new THREE.Quaternion(poses[i + 4], poses[i + 5], poses[i + 6], poses[i + 3]);
  return { at: new THREE.Vector3().fromArray(poses, i), up: new THREE.Vector3(0, 0, 1).applyQuaternion(turn) };
}

/** Do two planes through these frames lie in each other? */
function coincide(a: ReturnType<typeof frameOf>, b: ReturnType<typeof frameOf>, tolerance: number): boolean {
  return a.up.dot(b.up) > 0.9999 && Math.abs(b.at.clone().sub(a.at).dot(a.up)) < tolerance;
}

export class Walls {
  readonly object = new THREE.Group();
  private readonly grid: THREE.ShaderMaterial;
  private readonly shadow = new THREE.ShadowMaterial({ depthWrite: false });
  private readonly wall = new THREE.MeshLambertMaterial({ transparent: true, opacity: 0.16, depthWrite: false });
  private readonly edge = new THREE.LineBasicMaterial({ transparent: true, opacity: 0.75 });
  private readonly moving: { object: THREE.Object3D; body: number }[] = [];

  /** @param poses of all bodies at the beginning */
  constructor(run: Run, world: THREE.Sphere, poses: Float32Array) {
    this.grid = new THREE.ShaderMaterial({
      ...kGridShader,
      uniforms: {
        ground: { value: new THREE.Color() },
        line: { value: new THREE.Color() },
        cell: { value: roundLength(world.radius / 6) },
        radius: { value: 9 * world.radius },
      },
      transparent: true,
      depthWrite: false,
    });
    const { bodies } = run.header;
    const planes = bodies.flatMap((body, i) => (body.geometry === "plane" ? [frameOf(poses, i)] : []));
    bodies.forEach((body, index) => {
      if (body.geometry === "shape") return;
      const object = new THREE.Group();
      if (body.geometry === "plane") {
        object.add(this.plane(world));
      } else {
        // A floor that lies on a plane would be shaded twice.
        const own = frameOf(poses, index);
        const onPlane = planes.some((plane) => coincide(plane, own, 1e-3 * world.radius));
        object.add(this.container(body, !onPlane));
        if (!planes.length) object.add(this.plane(world, 0.002 * world.radius)); // for the eye only
      }
      this.moving.push({ object, body: index });
      this.object.add(object);
    });
  }

  setTheme(theme: Theme): void {
    this.grid.uniforms.ground.value.set(theme.ground);
    this.grid.uniforms.line.value.set(theme.line);
    this.shadow.opacity = theme.shadow;
    this.wall.color.set(theme.wall);
    this.edge.color.set(theme.wall);
  }

  update(poses: Float32Array): void {
    for (const { object, body } of this.moving) {
      const i = kPose * body;
      object.position.fromArray(poses, i);
      object.quaternion.set(poses[i + 4], poses[i + 5], poses[i + 6], poses[i + 3]);
    }
  }

  private plane(world: THREE.Sphere, below = 0): THREE.Object3D {
    const disc = new THREE.CircleGeometry(9 * world.radius, 96);
    const ground = new THREE.Mesh(disc, this.grid);
    ground.renderOrder = -2;
    const shadow = new THREE.Mesh(disc, this.shadow);
    shadow.receiveShadow = true;
    shadow.renderOrder = -1;
    const group = new THREE.Group();
    group.add(ground);
    if (!below) group.add(shadow);
    group.position.z = -below;
    return group;
  }

  /** Floor and four walls, seen from inside only, so that near walls hide nothing. */
  private container(body: BodyHeader, shadedFloor: boolean): THREE.Object3D {
    const [x, y, height] = body.extent ?? [1, 1, 1];
    const group = new THREE.Group();
    const face = (w: number, h: number, place: (m: THREE.Mesh) => void, shaded = true) => {
      const geometry = new THREE.PlaneGeometry(w, h);
      for (const material of shaded ? [this.wall, this.shadow] : [this.wall]) {
        const mesh = new THREE.Mesh(geometry, material);
        place(mesh);
        mesh.receiveShadow = true;
        mesh.renderOrder = -1;
        group.add(mesh);
      }
    };
    face(2 * x, 2 * y, () => {}, shadedFloor);
    face(2 * x, height, (m) => m.position.set(0, y, height / 2) && m.rotation.set(Math.PI / 2, 0, 0));
    face(2 * x, height, (m) => m.position.set(0, -y, height / 2) && m.rotation.set(-Math.PI / 2, 0, 0));
    face(height, 2 * y, (m) => m.position.set(x, 0, height / 2) && m.rotation.set(0, -Math.PI / 2, 0));
    face(height, 2 * y, (m) => m.position.set(-x, 0, height / 2) && m.rotation.set(0, Math.PI / 2, 0));
    const box = new THREE.BoxGeometry(2 * x, 2 * y, height);
    const edges = new THREE.LineSegments(new THREE.EdgesGeometry(box), this.edge);
    edges.position.z = height / 2;
    group.add(edges);
    return group;
  }
}
