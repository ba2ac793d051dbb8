/** The clock of the page: which moment of the run is shown. */

import { locate } from "./data/interpolate";
import type { Frames } from "./data/run";

export class Player {
  time: number;
  speed = 1;
  playing = false;
  loop = false;
  /** A running simulation: at its newest frame the clock waits instead of stopping. */
  live = false;

  constructor(private readonly frames: Frames) {
    this.time = this.begin;
  }

  get begin(): number {
    return this.frames.count ? this.frames.times[0] : 0;
  }
  get end(): number {
    return this.frames.count ? this.frames.times[this.frames.count - 1] : 0;
  }
  get atEnd(): boolean {
    return this.time >= this.end;
  }

  /** Moves on by wall-clock seconds. */
  advance(seconds: number): void {
    if (!this.playing) return;
    this.seek(this.time + seconds * this.speed);
    if (!this.atEnd || this.live) return;
    if (this.loop && this.end > this.begin) this.time = this.begin;
    else this.playing = false;
  }

  seek(time: number): void {
    this.time = Math.min(this.end, Math.max(this.begin, time));
  }

  play(): void {
    if (this.atEnd && !this.live) this.time = this.begin;
    this.playing = true;
  }

  /** Stops at the frame that lies `count` frames from the present one. */
  step(count: number): void {
    this.playing = false;
    if (!this.frames.count) return;
    const { index, fraction } = locate(this.frames.times, this.time);
    const from = count < 0 && fraction > 1e-6 ? index + 1 : index;
    const to = Math.min(this.frames.count - 1, Math.max(0, from + count));
    this.time = this.frames.times[to];
  }
}
