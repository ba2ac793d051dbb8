/** What the reader of the page chose. */

import type { ColourMode } from "./stage/colours";

export interface Options {
  theme: "light" | "dark";
  colour: ColourMode;
  walls: boolean;
  voxels: boolean;
  level: number;
  contacts: boolean;
  apparent: boolean;
  centres: boolean;
  trails: boolean;
  translucent: boolean;
  charts: boolean;
  panel: boolean;
  selected: number; // body, or -1
}

export type Toggle =
  | "walls" | "voxels" | "contacts" | "apparent" | "centres" | "trails" | "translucent" | "charts" | "panel";
