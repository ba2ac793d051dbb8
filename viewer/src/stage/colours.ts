/** Colours of bodies and of the page. */

import * as THREE from "three";

export type ColourMode = "material" | "speed" | "impulse" | "index";

/** Materials, in the order of the run's table. */
export const kMaterialColours = [
  0x5b8def, 0xf2a93b, 0x4fb286, 0xe4615a, 0x9a78d4, 0x3fb7c9, 0xd978a8, 0xa8b545, 0x8c9bb0, 0xb98a5e,
];

const kRamp = [0x3f5fc4, 0x3fa4d4, 0x63c99b, 0xf3d04f, 0xe5562f].map((c) => new THREE.Color(c));
export const kRampCss = "linear-gradient(90deg,#3f5fc4,#3fa4d4,#63c99b,#f3d04f,#e5562f)";
export const kFixedColour = new THREE.Color(0x9aa4b2);

/** Colour of a value in [0, 1] on the ramp from calm blue to hot red. */
export function rampColour(value: number, out: THREE.Color): THREE.Color {
  const x = Math.min(1, Math.max(0, value)) * (kRamp.length - 1);
  const i = Math.min(kRamp.length - 2, Math.floor(x));
  return out.lerpColors(kRamp[i], kRamp[i + 1], x - i);
}

/** Neighbouring indices get hues far apart. */
export function indexColour(index: number, out: THREE.Color): THREE.Color {
  const hue = (0.58 + index * 0.61803398875) % 1;
  return out.setHSL(hue, 0.48, 0.56 + 0.06 * Math.sin(index * 2.4), THREE.SRGBColorSpace);
}

export interface Theme {
  background: number;
  ground: number;
  line: number;
  shadow: number; // strength of shadows on the ground
  environment: number; // strength of the light from around
  sun: number;
  wall: number;
  accent: number;
}

export const kThemes: Record<"light" | "dark", Theme> = {
  light: {
    background: 0xeceff3, ground: 0xf7f8fa, line: 0xc9d0da, shadow: 0.24, environment: 0.62, sun: 2.1,
    wall: 0x7d8ea5, accent: 0x2467e8,
  },
  dark: {
    background: 0x14171c, ground: 0x20252d, line: 0x3b4452, shadow: 0.55, environment: 0.42, sun: 2.3,
    wall: 0x93a5bd, accent: 0x6ea3ff,
  },
};
