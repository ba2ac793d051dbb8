/** The bar below: play, step, time, speed. */

import type { Player } from "../player";
import { h, icon, iconButton } from "./dom";

const kSpeeds = [0.05, 0.1, 0.25, 0.5, 1, 2, 4, 10];

export interface TransportActions {
  togglePlay(): void;
  step(count: number): void;
  seek(time: number): void;
  changed(): void;
}

export class Transport {
  readonly element: HTMLElement;
  private readonly playButton: HTMLButtonElement;
  private readonly bar: HTMLInputElement;
  private readonly clock = h("span", { class: "clock" });
  private readonly speeds: HTMLSelectElement;
  private readonly loopButton: HTMLButtonElement;
  private shownPlaying?: boolean;

  constructor(private readonly player: Player, actions: TransportActions) {
    this.playButton = iconButton("play", "Play or pause (space)", actions.togglePlay);
    this.playButton.classList.add("primary");
    this.playButton.id = "play";
    this.bar = h("input", { type: "range", id: "time", min: "0", max: "1", step: "any", "aria-label": "Time" });
    this.bar.addEventListener("input", () => actions.seek(Number(this.bar.value)));
    this.speeds = h("select", { id: "speed", title: "Speed ([ and ])", "aria-label": "Speed" });
    for (const speed of kSpeeds) this.speeds.append(h("option", { value: String(speed) }, `${speed}×`));
    this.speeds.addEventListener("change", () => {
      player.speed = Number(this.speeds.value);
      this.speeds.blur();
      actions.changed();
    });
    this.loopButton = iconButton("loop", "Repeat (L)", () => this.toggleLoop());
    this.element = h(
      "div", { class: "card transport" },
      iconButton("back", "One frame back (←)", () => actions.step(-1)),
      this.playButton,
      iconButton("forward", "One frame on (→)", () => actions.step(1)),
      this.bar, this.clock, this.speeds, this.loopButton,
    );
  }

  toggleLoop(): void {
    this.player.loop = !this.player.loop;
    this.update();
  }

  /** Next slower (-1) or faster (+1) speed. */
  changeSpeed(direction: number): void {
    const index = kSpeeds.findIndex((speed) => speed >= this.player.speed);
    this.player.speed = kSpeeds[Math.min(kSpeeds.length - 1, Math.max(0, index + direction))];
    this.update();
  }

  update(): void {
    const { player, bar } = this;
    bar.min = String(player.begin);
    bar.max = String(player.end);
    bar.value = String(player.time);
    const part = player.end > player.begin ? (player.time - player.begin) / (player.end - player.begin) : 0;
    bar.style.setProperty("--part", `${100 * part}%`);
    this.clock.textContent = `${player.time.toFixed(2)} / ${player.end.toFixed(2)} s`;
    this.speeds.value = String(player.speed);
    this.loopButton.classList.toggle("on", player.loop);
    if (this.shownPlaying !== player.playing) {
      this.shownPlaying = player.playing;
      this.playButton.replaceChildren(icon(player.playing ? "pause" : "play"));
    }
  }
}
