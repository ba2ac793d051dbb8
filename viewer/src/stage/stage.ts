/** Renderer, camera and light. The z axis points up. */

import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { RoomEnvironment } from "three/examples/jsm/environments/RoomEnvironment.js";
import { Theme } from "./colours";

const kViewDirection = new THREE.Vector3(0.62, -1, 0.5).normalize();
const kSunDirection = new THREE.Vector3(0.45, -0.55, 1).normalize();

export class Stage {
  readonly scene = new THREE.Scene();
  readonly camera = new THREE.PerspectiveCamera(38, 1, 0.01, 1000);
  readonly renderer: THREE.WebGLRenderer;
  readonly controls: OrbitControls;
  private readonly sun = new THREE.DirectionalLight(0xfff6ea, 2);
  private readonly moved = new Set<() => void>();

  constructor(private readonly parent: HTMLElement) {
    this.renderer = new THREE.WebGLRenderer({ antialias: true, powerPreference: "high-performance" });
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    this.renderer.toneMapping = THREE.NeutralToneMapping;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = THREE.PCFShadowMap;
    parent.append(this.renderer.domElement);

    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.enableDamping = true;
    this.controls.dampingFactor = 0.12;
    this.controls.zoomToCursor = true;
    this.controls.addEventListener("change", () => this.moved.forEach((call) => call()));

    const maker = new THREE.PMREMGenerator(this.renderer);
    this.scene.environment = maker.fromScene(new RoomEnvironment(), 0.04).texture;
    this.scene.environmentRotation.set(Math.PI / 2, 0, 0); // its up is y
    maker.dispose();
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(2048, 2048);
    this.sun.shadow.radius = 3;
    this.scene.add(this.sun, this.sun.target);
  }

  onMove(call: () => void): void {
    this.moved.add(call);
  }

  setTheme(theme: Theme): void {
    this.scene.background = new THREE.Color(theme.background);
    this.scene.environmentIntensity = theme.environment;
    this.sun.intensity = theme.sun;
  }

  /** Light and clipping for a world of this extent. */
  setExtent(world: THREE.Sphere): void {
    const r = Math.max(world.radius, 1e-6);
    const shadow = this.sun.shadow;
    this.sun.target.position.copy(world.center);
    this.sun.position.copy(world.center).addScaledVector(kSunDirection, 3 * r);
    Object.assign(shadow.camera, { left: -r, right: r, top: r, bottom: -r, near: 0.5 * r, far: 6 * r });
    shadow.camera.updateProjectionMatrix();
    shadow.normalBias = r * 0.0012;
    shadow.bias = -0.0004;
    this.controls.minDistance = r * 0.01;
    this.controls.maxDistance = r * 30;
    this.camera.near = r * 0.004;
    this.camera.far = r * 80;
    this.camera.updateProjectionMatrix();
  }

  /** Moves the camera so that the sphere fills the picture; keeps the direction when asked to. */
  frame(target: THREE.Sphere, keepDirection: boolean): void {
    const direction = keepDirection
      ? this.camera.position.clone().sub(this.controls.target).normalize()
      : kViewDirection.clone();
    const half = THREE.MathUtils.degToRad(this.camera.fov / 2);
    const narrow = Math.atan(Math.tan(half) * Math.min(1, this.camera.aspect));
    const distance = (target.radius * 0.95) / Math.sin(narrow);
    this.controls.target.copy(target.center);
    this.camera.position.copy(target.center).addScaledVector(direction, distance);
    this.controls.update();
  }

  resize(): boolean {
    const { clientWidth: width, clientHeight: height } = this.parent;
    const size = this.renderer.getSize(new THREE.Vector2());
    if (!width || !height || (size.x === width && size.y === height)) return false;
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    return true;
  }

  render(): void {
    this.renderer.render(this.scene, this.camera);
  }

  /** The present picture as a PNG. */
  picture(): Promise<Blob | null> {
    this.render();
    return new Promise((resolve) => this.renderer.domElement.toBlob(resolve, "image/png"));
  }
}
