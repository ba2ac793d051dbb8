/** The panel at the left: colours, what is drawn, and facts about the run. */

import type { Run } from "../data/run";
import type { Options, Toggle } from "../options";
import { ColourMode, kMaterialColours, kRampCss } from "../stage/colours";
import type { ColourScales } from "../stage/world";
import { format, h } from "./dom";

const kColours: [ColourMode, string, string][] = [
  ["material", "Material", "1"],
  ["speed", "Speed", "2"],
  ["impulse", "Impulse", "3"],
  ["index", "Index", "4"],
];

const kToggles: [Toggle, string, string][] = [
  ["walls", "Planes and containers", "P"],
  ["contacts", "Contacts and impulses", "C"],
  ["apparent", "Apparent contact points", "A"],
  ["centres", "Centres of mass", "M"],
  ["trails", "Trails", "T"],
  ["translucent", "See-through bodies", "X"],
  ["voxels", "Voxel spheres", "V"],
];

export class Panel {
  readonly element: HTMLElement;
  private readonly colours = new Map<ColourMode, HTMLButtonElement>();
  private readonly boxes = new Map<Toggle, HTMLInputElement>();
  private readonly legend = h("div", { class: "legend" });
  private readonly level: HTMLInputElement;
  private readonly levelRow: HTMLElement;
  private readonly levelText = h("output");
  private readonly remark = h("p", { class: "remark" });

  constructor(
    private readonly run: Run, private readonly scales: ColourScales,
    private readonly options: Options, levels: number[], changed: () => void,
  ) {
    const segments = h("div", { class: "segments", role: "group", "aria-label": "Colours" });
    for (const [mode, label, key] of kColours) {
      const button = h("button", { type: "button", id: `colour-${mode}`, title: `${label} (${key})` }, label);
      button.addEventListener("click", () => {
        options.colour = mode;
        changed();
      });
      this.colours.set(mode, button);
      segments.append(button);
    }
    const toggles = h("div", { class: "toggles" });
    for (const [name, label, key] of kToggles) {
      const box = h("input", { type: "checkbox", id: `toggle-${name}` });
      box.disabled = name === "voxels" ? !levels.length : !this.available(name);
      box.addEventListener("change", () => {
        options[name] = box.checked;
        box.blur();
        changed();
      });
      this.boxes.set(name, box);
      toggles.append(h("label", box.disabled ? { class: "off" } : {}, box, h("span", {}, label), h("kbd", {}, key)));
    }
    this.level = h("input", {
      type: "range", id: "level", min: String(levels[0] ?? 1), max: String(levels.at(-1) ?? 1), "aria-label": "Level",
    });
    this.level.addEventListener("input", () => {
      options.level = Number(this.level.value);
      changed();
    });
    this.levelRow = h("div", { class: "level" }, h("span", {}, "Level"), this.level, this.levelText);
    this.element = h(
      "div", { class: "card panel" },
      h("h2", {}, "Colour"), segments, this.legend,
      h("h2", {}, "Show"), toggles, this.levelRow, this.remark,
      this.facts(),
    );
  }

  update(remark: string): void {
    for (const [mode, button] of this.colours) button.classList.toggle("on", mode === this.options.colour);
    for (const [name, box] of this.boxes) box.checked = this.options[name];
    this.levelRow.hidden = !this.options.voxels;
    this.level.value = String(this.options.level);
    this.levelText.textContent = String(this.options.level);
    this.remark.textContent = remark;
    this.drawLegend();
  }

  private available(name: Toggle): boolean {
    const { header } = this.run;
    if (name === "contacts") return !!header.contacts || !!header.live;
    if (name === "apparent") return !!header.apparent || !!header.live;
    return true;
  }

  drawLegend(): void {
    const { colour } = this.options;
    const ramp = (text: string) => {
      const bar = h("div", { class: "ramp" });
      bar.style.background = kRampCss;
      this.legend.replaceChildren(bar, h("div", { class: "ends" }, h("span", {}, "0"), h("span", {}, text)));
    };
    if (colour === "speed") ramp(`${format(this.scales.speed)} m/s`);
    else if (colour === "impulse") ramp(`${format(this.scales.impulse)} N s`);
    else if (colour === "material") {
      this.legend.replaceChildren(
        ...this.run.header.materials.map((material, i) => {
          const dot = h("i");
          dot.style.background = `#${kMaterialColours[i % kMaterialColours.length].toString(16).padStart(6, "0")}`;
          const title = `restitution ${material.restitution}, friction ${material.friction}`;
          return h("span", { class: "swatch", title }, dot, material.name);
        }),
      );
    } else this.legend.replaceChildren();
  }

  private facts(): HTMLElement {
    const { header } = this.run;
    const rows = header.facts.map(([name, value]) => h("div", {}, h("dt", {}, name), h("dd", {}, value)));
    const notes = header.notes.map((note) => h("li", {}, note));
    return h(
      "details", {}, h("summary", {}, "About this run"),
      h("dl", {}, ...rows), h("ul", {}, ...notes), h("p", { class: "remark" }, header.generator),
    );
  }
}
