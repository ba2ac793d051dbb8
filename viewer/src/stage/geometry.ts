/** Meshes made ready for drawing. */

import * as THREE from "three";
import type { Mesh } from "../data/run";

const kCrease = Math.cos((32 * Math.PI) / 180); // edges sharper than this stay sharp

/** A geometry whose normals are smooth except across creases. */
export function creasedGeometry(mesh: Mesh): THREE.BufferGeometry {
  const { positions, triangles } = mesh;
  const count = triangles.length / 3;
  const face = new Float32Array(3 * count); // area-weighted normals
  const a = new THREE.Vector3();
  const b = new THREE.Vector3();
  const c = new THREE.Vector3();
  for (let t = 0; t < count; ++t) {
    a.fromArray(positions, 3 * triangles[3 * t]);
    b.fromArray(positions, 3 * triangles[3 * t + 1]).sub(a);
    c.fromArray(positions, 3 * triangles[3 * t + 2]).sub(a);
    b.cross(c).toArray(face, 3 * t);
  }
  const around = facesAroundVertices(mesh);
  const corner = new Float32Array(9 * count);
  const normal = new Float32Array(9 * count);
  const own = new THREE.Vector3();
  const other = new THREE.Vector3();
  const sum = new THREE.Vector3();
  for (let t = 0; t < count; ++t) {
    own.fromArray(face, 3 * t);
    const ownLength = own.length() || 1;
    for (let k = 0; k < 3; ++k) {
      const vertex = triangles[3 * t + k];
      sum.set(0, 0, 0);
      for (let i = around.offset[vertex]; i < around.offset[vertex + 1]; ++i) {
        other.fromArray(face, 3 * around.face[i]);
        if (other.dot(own) >= kCrease * ownLength * other.length()) sum.add(other);
      }
      if (sum.lengthSq() === 0) sum.copy(own);
      sum.normalize().toArray(normal, 9 * t + 3 * k);
      for (let d = 0; d < 3; ++d) corner[9 * t + 3 * k + d] = positions[3 * vertex + d];
    }
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(corner, 3));
  geometry.setAttribute("normal", new THREE.BufferAttribute(normal, 3));
  geometry.computeBoundingSphere();
  return geometry;
}

function facesAroundVertices({ positions, triangles }: Mesh): { offset: Uint32Array; face: Uint32Array } {
  const offset = new Uint32Array(positions.length / 3 + 1);
  for (const vertex of triangles) ++offset[vertex + 1];
  for (let v = 1; v < offset.length; ++v) offset[v] += offset[v - 1];
  const face = new Uint32Array(triangles.length);
  const next = offset.slice();
  triangles.forEach((vertex, i) => (face[next[vertex]++] = Math.floor(i / 3)));
  return { offset, face };
}

/** An arrow along +z of length 1: shaft and head. */
export function arrowGeometry(): THREE.BufferGeometry {
  const profile = [
    [0, 0], [0.045, 0], [0.045, 0.66], [0.13, 0.66], [0, 1],
  ].map(([r, z]) => new THREE.Vector2(r, z));
  return new THREE.LatheGeometry(profile, 10).rotateX(Math.PI / 2);
}
