/** The card with the numbers of a selected body. */

import { kPose } from "../data/interpolate";
import type { Run } from "../data/run";
import type { World } from "../stage/world";
import { format, h, iconButton } from "./dom";

export class Inspector {
  readonly element: HTMLElement;
  private readonly title = h("h2", {});
  private readonly rows = h("dl");
  private readonly cells = new Map<string, HTMLElement>();

  constructor(private readonly run: Run, private readonly world: World, close: () => void) {
    const head = h("header", {}, this.title, iconButton("close", "Deselect (Esc)", close));
    this.element = h("div", { class: "card inspector" }, head, this.rows);
    this.element.hidden = true;
  }

  update(selected: number): void {
    this.element.hidden = selected < 0;
    if (selected < 0) return;
    const body = this.run.header.bodies[selected];
    const { poses, velocities, loads, contacts } = this.world;
    const vector = (values: Float32Array, at: number, n = 3) =>
      Array.from(values.subarray(at, at + n), format).join("  ");
    let touching = 0;
    let deepest = 0;
    for (let i = 0; i < contacts.count; ++i) {
      if (contacts.body[2 * i] !== selected && contacts.body[2 * i + 1] !== selected) continue;
      ++touching;
      deepest = Math.min(deepest, contacts.gap[i]);
    }
    this.title.textContent = body.name;
    this.set("Kind", `${body.kind}, ${this.run.header.materials[body.material]?.name ?? "–"}`);
    this.set("Shape", body.geometry === "shape" ? this.run.header.shapes[body.shape].name : body.geometry);
    this.set("Mass", body.mass > 0 ? `${format(body.mass)} kg` : "does not move");
    this.set("Centre", `${vector(poses, kPose * selected)} m`);
    this.set("Quaternion", vector(poses, kPose * selected + 3, 4));
    this.set("Velocity", `${vector(velocities, 6 * selected)} m/s`);
    this.set("Speed", `${format(this.world.speed(selected))} m/s`);
    this.set("Spin", `${vector(velocities, 6 * selected + 3)} rad/s`);
    this.set("Contacts", String(touching));
    this.set("Impulses", `${format(loads[selected])} N s in the step`);
    this.set("Overlap", `${format(-deepest * 1000)} mm`);
  }

  private set(name: string, value: string): void {
    let cell = this.cells.get(name);
    if (!cell) {
      cell = h("dd");
      this.cells.set(name, cell);
      this.rows.append(h("div", {}, h("dt", {}, name), cell));
    }
    if (cell.textContent !== value) cell.textContent = value;
  }
}
