import { connect } from "./data/live";
import { fromBase64, inflate } from "./data/container";
import { Run, readRun } from "./data/run";
import { App } from "./app";
import { h } from "./ui/dom";
import "./ui/style.css";

/** Shows what went wrong instead of an empty page. */
function fail(reason: unknown): void {
  const text = reason instanceof Error ? reason.message : String(reason);
  document.body.replaceChildren(h("div", { class: "failure" }, h("h1", {}, "This run cannot be shown"), h("p", {}, text)));
}

async function start(): Promise<void> {
  const place = document.getElementById("gotai-run")!;
  const text = place.textContent!.trim();
  if (place.dataset.source === "live") {
    let app: App | undefined;
    const link = await connect(() => app?.framesArrived(), () => app?.ended());
    app = new App(link.run, link);
    return;
  }
  if (!text) throw new Error("The page holds no run. Make one with: gotai view RUN.h5 -o RUN.html");
  const run: Run = readRun(await inflate(fromBase64(text)));
  place.textContent = ""; // the text is no longer needed
  new App(run);
}

start().catch(fail);
