/** Renderer, camera and light. The z axis points up. */

import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { RoomEnvironment } from "three/examples/jsm/environments/RoomEnvironment.js";
import { Theme } from "./colours";

const kViewDirection = new THREE.Vector3(0.62, -1, 0.5).normalize();
const kSunDirection = new THREE.Vector3(-0.55, -0.6, 1).normalize(); // from the left of the first view

/** Pixels along the edges of the page that panels cover. */
export interface Insets {
  left: number;
  right: number;
  top: number;
  bottom: number;
}

/** Is there no graphics card, so that every pixel costs time of the processor? */
function drawsInSoftware(): boolean {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) throw new Error("This browser has no WebGL 2, which the picture needs.");
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  const name = String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}

export class Stage {
  readonly simple = drawsInSoftware();
  readonly scene = new THREE.Scene();
  readonly camera = new THREE.PerspectiveCamera(38, 1, 0.01, 1000);
  readonly renderer: THREE.WebGLRenderer;
  readonly controls: OrbitControls;
  private readonly sun = new THREE.DirectionalLight(0xfff6ea, 2);
  /** Stands for the light from around where reflections would take too long. */
  private readonly sky = new THREE.HemisphereLight(0xffffff, 0xb9b4ae, 1);
  private readonly moved = new Set<() => void>();
  private insets: Insets = { left: 0, right: 0, top: 0, bottom: 0 };

  constructor(private readonly parent: HTMLElement) {
    const { simple } = this;
    document.documentElement.classList.toggle("simple", simple);
    this.renderer = new THREE.WebGLRenderer({ antialias: !simple, powerPreference: "high-performance" });
    this.renderer.setPixelRatio(simple ? 1 : Math.min(2, window.devicePixelRatio));
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

    if (simple) {
      this.sky.position.set(0, 0, 1);
      this.scene.add(this.sky);
    } else {
      const maker = new THREE.PMREMGenerator(this.renderer);
      this.scene.environment = maker.fromScene(new RoomEnvironment(), 0.04).texture;
      this.scene.environmentRotation.set(Math.PI / 2, 0, 0); // its up is y
      maker.dispose();
    }
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.setScalar(simple ? 1024 : 2048);
    this.sun.shadow.radius = simple ? 1 : 3;
    this.scene.add(this.sun, this.sun.target);
  }

  onMove(call: () => void): void {
    this.moved.add(call);
  }

  setTheme(theme: Theme): void {
    this.scene.background = new THREE.Color(theme.background);
    this.scene.environmentIntensity = theme.environment;
    this.sky.intensity = 3.6 * theme.environment;
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

  /** Moves the camera so that the box fills what the panels leave free; keeps the direction when asked to. */
  frame(box: THREE.Box3, keepDirection: boolean): void {
    const { camera } = this;
    const target = box.getCenter(new THREE.Vector3());
    const back = keepDirection
      ? camera.position.clone().sub(this.controls.target).normalize()
      : kViewDirection.clone();
    const right = new THREE.Vector3(0, 0, 1).cross(back).normalize();
    const up = back.clone().cross(right);
    const { width, height } = this.free();
    const tangent = Math.tan(THREE.MathUtils.degToRad(camera.fov / 2)) / this.parent.clientHeight;
    let distance = 0;
    const corner = new THREE.Vector3();
    for (let i = 0; i < 8; ++i) {
      corner.set((i & 1 ? box.max : box.min).x, (i & 2 ? box.max : box.min).y, (i & 4 ? box.max : box.min).z).sub(target);
      const wide = Math.abs(corner.dot(right)) / (tangent * width);
      const high = Math.abs(corner.dot(up)) / (tangent * height);
      distance = Math.max(distance, 1.04 * Math.max(wide, high) + corner.dot(back));
    }
    this.controls.target.copy(target);
    camera.position.copy(target).addScaledVector(back, distance);
    this.controls.update();
  }

  /** Moves the middle of the picture to the middle of what the panels leave free. */
  setInsets(insets: Insets): void {
    this.insets = insets;
    const { clientWidth: width, clientHeight: height } = this.parent;
    const free = this.free();
    // On small screens panels may cover nearly everything: then they lie over the picture.
    const roomy = free.width > 200 && free.height > 200;
    const x = roomy ? (insets.left - insets.right) / 2 : 0;
    const y = roomy ? (insets.top - insets.bottom) / 2 : 0;
    this.camera.setViewOffset(width, height, -x, -y, width, height);
  }

  private free(): { width: number; height: number } {
    const { clientWidth: width, clientHeight: height } = this.parent;
    const { left, right, top, bottom } = this.insets;
    const free = { width: width - left - right, height: height - top - bottom };
    return free.width > 200 && free.height > 200 ? free : { width, height };
  }

  resize(): boolean {
    const { clientWidth: width, clientHeight: height } = this.parent;
    const size = this.renderer.getSize(new THREE.Vector2());
    if (!width || !height || (size.x === width && size.y === height)) return false;
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.setInsets(this.insets);
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
