/** The spheres around the voxels of a pyramid level: what the thesis's collision model sees. */

import * as THREE from "three";
import { kPose } from "../data/interpolate";
import type { Run } from "../data/run";

const kMostSpheres = 120_000;

type Shader = THREE.WebGLProgramParametersWithUniforms;

/** Drawn in the shader from a table of poses, so that moving them costs one small upload. */
export class VoxelSpheres {
  readonly object = new THREE.Group();
  private readonly poses: THREE.DataTexture;
  private readonly tint: THREE.DataTexture;
  private readonly material = new THREE.MeshStandardMaterial({ roughness: 0.6 });
  private readonly shadow = new THREE.MeshDepthMaterial({ depthPacking: THREE.RGBADepthPacking });
  private readonly bodies: number;
  private shown = "";

  constructor(private readonly run: Run, private readonly simple: boolean) {
    this.bodies = run.header.bodies.length;
    const table = (width: number) =>
      new THREE.DataTexture(
        new Float32Array(4 * width * this.bodies), width, this.bodies, THREE.RGBAFormat, THREE.FloatType,
      );
    this.poses = table(2);
    this.tint = table(1);
    this.shadow.onBeforeCompile = (shader) => this.place(shader);
    this.material.onBeforeCompile = (shader) => {
      this.place(shader);
      shader.fragmentShader = shader.fragmentShader
        .replace("#include <common>", "#include <common>\nvarying vec3 sphereTint;")
        .replace("#include <color_fragment>", "diffuseColor.rgb *= sphereTint;");
    };
  }

  /** Lets a vertex shader move each sphere with its body. */
  private place(shader: Shader): void {
    shader.uniforms.poses = { value: this.poses };
    shader.uniforms.tint = { value: this.tint };
    shader.vertexShader = shader.vertexShader
      .replace(
        "#include <common>",
        /* glsl */ `#include <common>
        attribute vec4 sphere; // centre about the centre of mass, radius
        attribute float body;
        uniform sampler2D poses, tint;
        varying vec3 sphereTint;
        vec3 turn(vec4 q, vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }`,
      )
      .replace(
        "#include <begin_vertex>",
        /* glsl */ `vec4 centre = texelFetch(poses, ivec2(0, int(body)), 0);
        vec4 q = texelFetch(poses, ivec2(1, int(body)), 0);
        sphereTint = texelFetch(tint, ivec2(0, int(body)), 0).rgb;
        vec3 transformed = centre.w * (position * sphere.w + turn(q, sphere.xyz)) + centre.xyz;`,
      );
  }

  /**
   * Shows a level of all bodies, or of one body (>= 0) when all would be too many.
   * Returns what is drawn, for people.
   */
  show(level: number, selected: number): string {
    const all = this.shapeBodies().filter((b) => this.voxelsOf(b, level));
    const total = all.reduce((sum, b) => sum + this.voxelsOf(b, level)!.centers.length / 3, 0);
    const tooMany = total > kMostSpheres;
    const bodies = tooMany ? all.filter((b) => b === selected) : all;
    const key = `${level}:${tooMany ? selected : "all"}`;
    if (key !== this.shown) {
      this.shown = key;
      this.rebuild(bodies, level);
    }
    if (!all.length) return `no voxels of level ${level} in this file`;
    const count = total.toLocaleString("en");
    return tooMany ? `${count} spheres are too many: click a body to see its own` : `${count} spheres`;
  }

  update(poses: Float32Array, present: Uint8Array, colours: Float32Array): void {
    if (!this.object.visible) return;
    const table = this.poses.image.data as Float32Array;
    const tint = this.tint.image.data as Float32Array;
    for (let b = 0; b < this.bodies; ++b) {
      const i = kPose * b;
      table.set([poses[i], poses[i + 1], poses[i + 2], present[b], poses[i + 4], poses[i + 5], poses[i + 6], poses[i + 3]], 8 * b);
      tint.set([colours[3 * b], colours[3 * b + 1], colours[3 * b + 2], 1], 4 * b);
    }
    this.poses.needsUpdate = true;
    this.tint.needsUpdate = true;
  }

  private shapeBodies(): number[] {
    return this.run.header.bodies.flatMap((body, i) => (body.geometry === "shape" ? [i] : []));
  }

  private voxelsOf(body: number, level: number) {
    return this.run.voxels[this.run.header.bodies[body].shape].get(level);
  }

  private rebuild(bodies: number[], level: number): void {
    for (const child of [...this.object.children]) {
      (child as THREE.Mesh).geometry.dispose();
      this.object.remove(child);
    }
    const count = bodies.reduce((sum, b) => sum + this.voxelsOf(b, level)!.centers.length / 3, 0);
    if (!count) return;
    const sphere = new Float32Array(4 * count);
    const owner = new Float32Array(count);
    let at = 0;
    for (const body of bodies) {
      const { centers, edge } = this.voxelsOf(body, level)!;
      const com = this.run.header.shapes[this.run.header.bodies[body].shape].com;
      const radius = (Math.sqrt(3) / 2) * edge;
      for (let i = 0; i < centers.length; i += 3) {
        sphere.set([centers[i] - com[0], centers[i + 1] - com[1], centers[i + 2] - com[2], radius], 4 * at);
        owner[at++] = body;
      }
    }
    const base = new THREE.IcosahedronGeometry(1, count > 20_000 || this.simple ? 1 : count > 4000 ? 2 : 3);
    const geometry = new THREE.InstancedBufferGeometry();
    geometry.setAttribute("position", base.getAttribute("position"));
    geometry.setAttribute("normal", base.getAttribute("position")); // a unit sphere is its own normal
    geometry.setAttribute("sphere", new THREE.InstancedBufferAttribute(sphere, 4));
    geometry.setAttribute("body", new THREE.InstancedBufferAttribute(owner, 1));
    geometry.instanceCount = count;
    const mesh = new THREE.Mesh(geometry, this.material);
    mesh.frustumCulled = false;
    mesh.castShadow = true;
    mesh.receiveShadow = true;
    mesh.customDepthMaterial = this.shadow;
    this.object.add(mesh);
  }
}
