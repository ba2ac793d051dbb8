/** The overlay that lists keys and mouse. */

import { h, iconButton } from "./dom";

const kHelp: [string, [string, string][]][] = [
  ["Play", [
    ["Space", "play, pause"],
    ["← →", "one frame back, on"],
    ["Shift ← →", "ten frames"],
    ["Home End", "begin, end"],
    ["[ ]", "slower, faster"],
    ["L", "repeat"],
  ]],
  ["Look", [
    ["Drag", "orbit"],
    ["Right drag", "pan"],
    ["Wheel", "zoom to the cursor"],
    ["Click", "numbers of a body"],
    ["F", "frame the selection, or all"],
    ["Esc", "deselect, close"],
  ]],
  ["Show", [
    ["1 2 3 4", "colour by material, speed, impulse, index"],
    ["P C A", "planes, contacts, apparent contacts"],
    ["M T X", "centres of mass, trails, see-through"],
    ["V", "voxel spheres"],
    [", .", "coarser, finer level"],
  ]],
  ["Page", [
    ["S", "save a picture"],
    ["D", "dark, light"],
    ["G", "charts"],
    ["O", "options"],
    ["H ?", "this help"],
  ]],
];

export class Help {
  readonly element: HTMLElement;

  constructor() {
    const blocks = kHelp.map(([title, keys]) =>
      h("section", {}, h("h3", {}, title), h("dl", {}, ...keys.map(([key, text]) => {
        const caps = key.split(" ").map((k) => h("kbd", {}, k));
        return h("div", {}, h("dt", {}, ...caps), h("dd", {}, text));
      }))));
    const box = h("div", { class: "card help" },
      h("header", {}, h("h2", {}, "Keys and mouse"), iconButton("close", "Close (Esc)", () => this.toggle(false))),
      h("div", { class: "columns" }, ...blocks));
    this.element = h("div", { class: "veil" }, box);
    this.element.hidden = true;
    this.element.addEventListener("click", (event) => {
      if (event.target === this.element) this.toggle(false);
    });
  }

  toggle(show = this.element.hidden): void {
    this.element.hidden = !show;
  }
}
