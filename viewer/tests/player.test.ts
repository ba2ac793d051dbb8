import { describe, expect, it } from "vitest";
import { kNoContacts, Frames } from "../src/data/run";
import { Player } from "../src/player";

function frames(times: number[]): Frames {
  return {
    times,
    get count() {
      return times.length;
    },
    poses: () => {}, velocities: () => {}, loads: () => {}, contacts: () => kNoContacts, apparent: () => kNoContacts,
  };
}

describe("the clock", () => {
  it("runs at its speed and stops at the end", () => {
    const player = new Player(frames([0, 1, 2]));
    player.play();
    player.speed = 0.5;
    player.advance(1);
    expect(player.time).toBe(0.5);
    player.speed = 10;
    player.advance(1);
    expect(player.time).toBe(2);
    expect(player.playing).toBe(false);
    player.play();
    expect(player.time).toBe(0);
  });
  it("repeats when asked to", () => {
    const player = new Player(frames([0, 1]));
    player.loop = true;
    player.play();
    player.advance(5);
    expect(player).toMatchObject({ time: 0, playing: true });
  });
  it("steps to frames, also from between two", () => {
    const player = new Player(frames([0, 0.1, 0.2, 0.3]));
    player.seek(0.25);
    player.step(1);
    expect(player.time).toBe(0.3);
    player.seek(0.25);
    player.step(-1);
    expect(player.time).toBe(0.2);
    player.step(-10);
    expect(player.time).toBe(0);
    player.step(-1);
    expect(player.time).toBe(0);
  });
  it("waits for a running simulation", () => {
    const times = [0, 1];
    const player = new Player(frames(times));
    player.live = true;
    player.play();
    player.advance(3);
    expect(player).toMatchObject({ time: 1, playing: true });
    times.push(2);
    player.advance(0.5);
    expect(player.time).toBe(1.5);
  });
  it("lives with no frames", () => {
    const player = new Player(frames([]));
    player.play();
    player.advance(1);
    player.step(1);
    expect(player.time).toBe(0);
  });
});
