/** Frames of a simulation that is still running, as its server sends them. */

import { Container, fromBase64, readContainer } from "./container";
import { Contacts, Frames, Run, Series, kNoContacts, readRun } from "./run";

interface LiveHeader {
  time: number;
  bodies: number;
  steps: Record<string, number>[]; // measurements since the last frame, with "time"
}

interface LiveFrame {
  pose: Float32Array;
  velocity: Float32Array;
  load: Float32Array;
  contacts: Contacts;
  apparent: Contacts;
}

const kMostFailures = 3; // connections lost in a row
const kKeptFrames = 3600; // a minute at 60 per second

function readContacts(file: Container<LiveHeader>, name: string): Contacts {
  if (!file.has(`${name}.body`)) return kNoContacts;
  const body = file.array(`${name}.body`) as Uint32Array;
  return {
    count: body.length / 2,
    body,
    point: file.array(`${name}.point`) as Float32Array,
    normal: file.array(`${name}.normal`) as Float32Array,
    impulse: file.array(`${name}.impulse`) as Float32Array,
    gap: file.array(`${name}.gap`) as Float32Array,
  };
}

/** The last frames that arrived. */
export class LiveFrames implements Frames {
  private frames: LiveFrame[] = [];
  times: number[] = [];

  get count(): number {
    return this.frames.length;
  }

  push(time: number, frame: LiveFrame): void {
    this.frames.push(frame);
    this.times.push(time);
    if (this.frames.length > kKeptFrames) {
      this.frames.shift();
      this.times.shift();
    }
  }

  poses(frame: number, out: Float32Array): void {
    out.set(this.frames[frame].pose);
  }
  velocities(frame: number, out: Float32Array): void {
    out.set(this.frames[frame].velocity);
  }
  loads(frame: number, out: Float32Array): void {
    out.set(this.frames[frame].load);
  }
  contacts(frame: number): Contacts {
    return this.frames[frame].contacts;
  }
  apparent(frame: number): Contacts {
    return this.frames[frame].apparent;
  }
}

/** Adds one message of the server to the frames and the measurements. */
export function takeMessage(text: string, frames: LiveFrames, series: Series): void {
  const file = readContainer<LiveHeader>(fromBase64(text));
  frames.push(file.header.time, {
    pose: file.array("pose") as Float32Array,
    velocity: file.array("velocity") as Float32Array,
    load: file.array("load") as Float32Array,
    contacts: readContacts(file, "contacts"),
    apparent: readContacts(file, "apparent"),
  });
  for (const step of file.header.steps) {
    series.time.push(step.time);
    for (const [name, values] of series.values) values.push(step[name] ?? NaN);
  }
}

export interface LiveLink {
  run: Run;
  pause(paused: boolean): void;
  step(): void;
}

/** Connects to the server this page came from. `onFrame` and `onEnd` report what happens. */
export async function connect(onFrame: () => void, onEnd: () => void): Promise<LiveLink> {
  const answer = await fetch("scene");
  if (!answer.ok) throw new Error(`the simulation answered ${answer.status}`);
  const frames = new LiveFrames();
  const run = readRun(new Uint8Array(await answer.arrayBuffer()), frames);
  // One after the other: a step that overtakes "resume" would pause again.
  let commands = Promise.resolve();
  const command = (name: string) => {
    const send = async () => void (await fetch(name, { method: "POST" }));
    commands = commands.then(send).catch(() => undefined); // the events tell when the run has ended
  };
  let next = 0; // number of the frame that comes next
  let failures = 0;
  await new Promise<void>((resolve) => {
    const finish = () => {
      onEnd();
      resolve();
    };
    const listen = () => {
      const events = new EventSource(`events?from=${next}`);
      events.addEventListener("frame", (event) => {
        const message = event as MessageEvent<string>;
        failures = 0;
        next = Number(message.lastEventId) + 1;
        takeMessage(message.data, frames, run.series);
        onFrame();
        resolve();
      });
      events.addEventListener("end", () => {
        events.close();
        finish();
      });
      // A lost connection is taken up again; nobody answers any more when the run was killed.
      events.onerror = () => {
        events.close();
        if (++failures < kMostFailures) setTimeout(listen, 300);
        else finish();
      };
    };
    listen();
  });
  return {
    run,
    pause: (paused) => command(paused ? "pause" : "resume"),
    step: () => command("step"),
  };
}
