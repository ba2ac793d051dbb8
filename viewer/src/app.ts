/** Wires the page together: one run, one clock, one picture. */

import * as THREE from "three";
import type { LiveLink } from "./data/live";
import type { Run } from "./data/run";
import type { Options, Toggle } from "./options";
import { Player } from "./player";
import { ColourMode, kThemes } from "./stage/colours";
import { Stage } from "./stage/stage";
import { World } from "./stage/world";
import { Charts } from "./ui/charts";
import { h, iconButton } from "./ui/dom";
import { Help } from "./ui/help";
import { Inspector } from "./ui/inspector";
import { listen } from "./ui/keys";
import { Panel } from "./ui/panel";
import { Transport } from "./ui/transport";

const kNarrow = 760; // pixels: below, panels start closed

export class App {
  private readonly options: Options;
  private readonly levels: number[];
  private readonly player: Player;
  private readonly stage: Stage;
  private readonly world: World;
  private readonly transport: Transport;
  private readonly panel: Panel;
  private readonly charts: Charts;
  private readonly inspector: Inspector;
  private readonly help = new Help();
  private readonly subtitle = h("p");
  private dirty = true;
  private stepping = false; // waits for the frame of a single step
  private last = performance.now();

  constructor(private readonly run: Run, private readonly link?: LiveLink) {
    const { header } = run;
    document.title = `${header.title} · Gotai`;
    this.levels = [...new Set(run.voxels.flatMap((levels) => [...levels.keys()]))].sort((a, b) => a - b);
    this.options = this.firstOptions();
    this.player = new Player(run.frames);
    this.player.live = !!link;

    const view = h("div", { class: "view" });
    document.body.replaceChildren(view);
    this.stage = new Stage(view);
    this.world = new World(run, this.stage.simple);
    this.stage.scene.add(this.world.object);
    this.stage.setExtent(this.world.extent);
    this.stage.onMove(() => (this.dirty = true));

    const changed = () => this.apply();
    this.transport = new Transport(this.player, {
      togglePlay: () => this.togglePlay(),
      step: (count) => this.step(count),
      seek: (time) => this.seek(time),
      changed,
    });
    this.panel = new Panel(run, this.world.scales, this.options, this.levels, changed);
    this.charts = new Charts(run, (time) => this.seek(time));
    this.inspector = new Inspector(run, this.world, () => this.select(-1));
    document.body.append(
      h("header", { class: "title" }, h("h1", {}, header.title), this.subtitle),
      this.tools(),
      h("aside", { class: "left" }, this.panel.element),
      h("aside", { class: "right" }, this.inspector.element, this.charts.element),
      this.transport.element,
      this.help.element,
    );
    this.pickOnClick(view);
    this.bindKeys();
    window.addEventListener("resize", () => (this.dirty = true));
    this.apply();
    this.stage.resize();
    this.stage.frame(this.world.boxOf(-1), false);
    if (link) this.player.play();
    requestAnimationFrame((now) => this.tick(now));
  }

  /** New frames have come from the simulation. */
  framesArrived(): void {
    if (this.stepping) this.player.seek(this.player.end);
    this.stepping = false;
    this.dirty = true;
  }

  /** The simulation has ended: what has come so far stays and can be played. */
  ended(): void {
    this.player.live = false;
    this.run.header.live = false;
    this.run.header.title += " (ended)";
    this.dirty = true;
  }

  private firstOptions(): Options {
    const moving = this.run.header.bodies.filter((body) => body.kind !== "fixed");
    const materials = new Set(moving.map((body) => body.material));
    const wide = window.innerWidth > kNarrow;
    return {
      theme: window.matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light",
      colour: materials.size > 1 ? "material" : "index",
      walls: true, voxels: false, contacts: false, apparent: false, centres: false, trails: false,
      translucent: false, charts: wide, panel: wide,
      level: this.levels.includes(this.run.header.level) ? this.run.header.level : (this.levels.at(-1) ?? 1),
      selected: -1,
    };
  }

  private apply(): void {
    const { options } = this;
    const themed = document.documentElement.dataset.theme !== options.theme;
    document.documentElement.dataset.theme = options.theme;
    this.stage.setTheme(kThemes[options.theme]);
    this.panel.update(this.world.apply(options));
    this.panel.element.hidden = !options.panel;
    const hidden = this.charts.element.hidden;
    this.charts.element.hidden = !options.charts || this.charts.empty;
    if (themed || hidden !== this.charts.element.hidden) this.charts.build();
    this.layOut();
    this.dirty = true;
  }

  /** Shares the page between the picture and the panels around it. */
  private layOut(): void {
    this.inspector.update(this.options.selected);
    this.charts.fit();
    const reach = (element: HTMLElement) => (element.hidden ? 0 : element.getBoundingClientRect().width + 14);
    this.stage.setInsets({
      left: reach(this.panel.element),
      right: Math.max(reach(this.inspector.element), reach(this.charts.element)),
      top: 66,
      bottom: 78,
    });
  }

  private tick(now: number): void {
    const seconds = Math.min(1, (now - this.last) / 1000); // not all the time that the page was hidden
    this.last = now;
    const before = this.player.time;
    this.player.advance(seconds);
    if (this.stage.resize()) {
      if (this.options.panel && this.options.charts) this.makeRoom("panel");
      this.panel.element.hidden = !this.options.panel;
      this.charts.build();
      this.layOut();
      this.dirty = true;
    }
    this.stage.controls.update();
    if (this.dirty || before !== this.player.time) this.draw();
    requestAnimationFrame((next) => this.tick(next));
  }

  private draw(): void {
    this.dirty = false;
    const { player, world, options } = this;
    world.show(player.time, options);
    this.stage.render();
    this.transport.update();
    if (!this.charts.element.hidden) this.charts.update(player.time);
    this.inspector.update(options.selected);
    if (this.run.header.live) this.panel.drawLegend();
    const contacts = world.contacts?.count ?? 0;
    const bodies = world.moving.length;
    const plural = (n: number, word: string) => `${n.toLocaleString("en")} ${word}${n === 1 ? "" : "s"}`;
    this.subtitle.textContent =
      `${plural(bodies, "moving body").replace("bodys", "bodies")}` +
      (this.run.header.contacts || this.run.header.live ? ` · ${plural(contacts, "contact")}` : "") +
      (player.live ? " · live" : "");
    document.documentElement.dataset.ready = "true";
    document.documentElement.dataset.time = player.time.toFixed(6);
  }

  private togglePlay(): void {
    if (this.player.playing) this.player.playing = false;
    else this.player.play();
    this.link?.pause(!this.player.playing);
    this.dirty = true;
  }

  private step(count: number): void {
    const atNewest = this.player.live && count > 0 && this.player.atEnd;
    this.player.step(count);
    if (atNewest) {
      this.link?.step();
      this.stepping = true;
    } else if (this.player.live) {
      this.link?.pause(true);
    }
    this.dirty = true;
  }

  private seek(time: number): void {
    this.player.seek(time);
    this.dirty = true;
  }

  private toggle(name: Toggle): void {
    this.options[name] = !this.options[name];
    if (name === "panel" && this.options.panel) this.makeRoom("charts");
    if (name === "charts" && this.options.charts) this.makeRoom("panel");
    this.apply();
  }

  /** A small page has room for one of them. */
  private makeRoom(other: "panel" | "charts"): void {
    if (window.innerWidth <= kNarrow) this.options[other] = false;
  }

  private colour(mode: ColourMode): void {
    this.options.colour = mode;
    this.apply();
  }

  private select(body: number): void {
    this.options.selected = body;
    this.apply();
  }

  private changeLevel(by: number): void {
    const at = this.levels.indexOf(this.options.level) + by;
    if (this.levels[at] === undefined) return;
    this.options.level = this.levels[at];
    this.apply();
  }

  private frameView(): void {
    this.stage.frame(this.world.boxOf(this.options.selected), true);
    this.dirty = true;
  }

  private switchTheme(): void {
    this.options.theme = this.options.theme === "dark" ? "light" : "dark";
    this.apply();
  }

  private async savePicture(): Promise<void> {
    const blob = await this.stage.picture();
    if (!blob) return;
    const url = URL.createObjectURL(blob);
    const name = `${this.run.header.title.replace(/[^\w-]+/g, "-")}-${this.player.time.toFixed(3)}s.png`;
    h("a", { href: url, download: name }).click();
    URL.revokeObjectURL(url);
  }

  private tools(): HTMLElement {
    return h(
      "nav", { class: "card tools" },
      iconButton("sliders", "Options (O)", () => this.toggle("panel")),
      iconButton("charts", "Charts (G)", () => this.toggle("charts")),
      iconButton("frame", "Frame (F)", () => this.frameView()),
      iconButton("camera", "Save a picture (S)", () => void this.savePicture()),
      iconButton("theme", "Dark or light (D)", () => this.switchTheme()),
      iconButton("help", "Help (H)", () => this.help.toggle()),
    );
  }

  /** A press and release at the same place selects; a drag moves the camera. */
  private pickOnClick(view: HTMLElement): void {
    let down: PointerEvent | undefined;
    view.addEventListener("pointerdown", (event) => (down = event), { capture: true });
    view.addEventListener("pointerup", (event) => {
      if (!down || event.button !== 0) return;
      if (Math.hypot(event.clientX - down.clientX, event.clientY - down.clientY) > 4) return;
      const box = view.getBoundingClientRect();
      const at = new THREE.Vector2(
        ((event.clientX - box.left) / box.width) * 2 - 1,
        1 - ((event.clientY - box.top) / box.height) * 2,
      );
      const ray = new THREE.Raycaster();
      ray.setFromCamera(at, this.stage.camera);
      this.select(this.world.pick(ray));
    }, { capture: true });
  }

  private bindKeys(): void {
    const toggles = { p: "walls", c: "contacts", a: "apparent", m: "centres", t: "trails", x: "translucent",
      v: "voxels", g: "charts", o: "panel" } as const;
    const colours = { "1": "material", "2": "speed", "3": "impulse", "4": "index" } as const;
    listen({
      " ": () => this.togglePlay(),
      ArrowLeft: () => this.step(-1),
      ArrowRight: () => this.step(1),
      "Shift+ArrowLeft": () => this.step(-10),
      "Shift+ArrowRight": () => this.step(10),
      Home: () => this.seek(this.player.begin),
      End: () => this.seek(this.player.end),
      "[": () => this.transport.changeSpeed(-1),
      "]": () => this.transport.changeSpeed(1),
      l: () => this.transport.toggleLoop(),
      f: () => this.frameView(),
      s: () => void this.savePicture(),
      d: () => this.switchTheme(),
      h: () => this.help.toggle(),
      "?": () => this.help.toggle(),
      ",": () => this.changeLevel(-1),
      ".": () => this.changeLevel(1),
      Escape: () => (this.help.element.hidden ? this.select(-1) : this.help.toggle(false)),
      ...Object.fromEntries(Object.entries(toggles).map(([key, name]) => [key, () => this.toggle(name)])),
      ...Object.fromEntries(Object.entries(colours).map(([key, mode]) => [key, () => this.colour(mode)])),
    });
  }
}
