// node live.mjs GOTAI SCENE.toml: watches a simulation while it runs.
import { execFileSync, spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { request } from "node:http";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { assert, changed, findChromium, grab, kSkip, openPage } from "./browser.mjs";

if (!findChromium()) {
  console.log("skipped: no chromium here (apt-get install chromium, or set GOTAI_CHROMIUM)");
  process.exit(kSkip);
}
const [gotai, scene] = process.argv.slice(2);
const folder = mkdtempSync(join(tmpdir(), "gotai-live-"));
const recording = join(folder, "run.h5");

// Steps so small that the run takes longer than its own time and can be watched.
const kSlow = ["world.duration=1000", "time.step=2e-6", "impulse.method=impulse"].flatMap((setting) => ["--set", setting]);

/** Starts a run; gives the process and the address that it prints. */
function startRun(...more) {
  const process = spawn(gotai, ["run", scene, ...kSlow, "-o", recording, "--live", ...more]);
  const ended = new Promise((done) => process.on("exit", done));
  const address = new Promise((done, failed) => {
    let text = "";
    const take = (data) => {
      text += data;
      const found = /http:\/\/127\.0\.0\.1:\d+\//.exec(text);
      if (found) done(found[0]);
    };
    process.stdout.on("data", take);
    process.stderr.on("data", take);
    ended.then(() => failed(new Error(`the run ended early: ${text}`)));
  });
  return { process, ended, address };
}

/** Status of a request with these headers. */
const status = (url, method, headers) =>
  new Promise((done, failed) => {
    const out = request(url, { method, headers }, (answer) => {
      answer.resume();
      done(answer.statusCode);
    });
    out.on("error", failed);
    out.end();
  });

/** Kills a second run while a page looks at it. */
async function kill(frames) {
  const run = startRun("--force");
  try {
    const address = await run.address;
    const opened = await openPage(address, () => true);
    ({ close } = opened);
    await opened.page.waitForFunction(() => Number(document.documentElement.dataset.time) > 0.1);
    run.process.kill("SIGKILL");
    await run.ended;
    await opened.page.waitForFunction(() => !document.querySelector(".title p").textContent.includes("live"));
    assert(true, "the page of a killed run says that it has ended");
    assert(await status(address, "GET", {}).catch(() => 0) === 0, "nobody serves it any more");
    assert(frames() > 2, "the recording of a killed run can be read");
  } finally {
    run.process.kill("SIGKILL");
  }
}

const run = startRun();
let close = async () => {};
let wrong = [];
try {
  const address = await run.address;
  assert((await status(`${address}pause`, "POST", {})) === 204, "the run waits for the page");
  const opened = await openPage(address, (url) => url.startsWith(address) || /^(data|blob):/.test(url));
  ({ close, wrong } = opened);
  const { page } = opened;
  page.setDefaultTimeout(60_000);
  const time = () => page.$eval("html", (html) => Number(html.dataset.time));
  await page.waitForSelector("html[data-ready]");
  const first = await grab(page);
  const begin = await time();
  assert(begin < 0.5, "the page shows the beginning");
  await status(`${address}resume`, "POST", {});
  const resumed = Date.now();
  await page.waitForFunction((t) => Number(document.documentElement.dataset.time) > t + 0.1, begin);
  console.log(`ok: the bodies have moved for 0.1 s after ${((Date.now() - resumed) / 1000).toFixed(2)} s (drawn in software)`);
  assert(changed(first, await grab(page)) > 100, "the bodies move");

  await page.keyboard.press("Space");
  await page.waitForTimeout(500);
  const end = () => page.$eval("#time", (bar) => Number(bar.max));
  const paused = await end();
  await page.waitForTimeout(500);
  assert((await end()) === paused, "space pauses the simulation");
  await page.keyboard.press("End");
  for (let i = 0; i < 20; ++i) await page.keyboard.press("ArrowRight");
  await page.waitForFunction((t) => Number(document.querySelector("#time").max) > t, paused);
  assert((await end()) - paused < 1, "the arrow makes single steps");
  await page.keyboard.press("Space");
  const before = await time();
  await page.waitForFunction((t) => Number(document.documentElement.dataset.time) > t + 0.2, before);
  assert(true, "space resumes it");

  assert((await status(`${address}scene`, "GET", { Origin: "http://example.org" })) === 403, "another origin is refused");
  assert((await status(`${address}pause`, "POST", { Origin: "http://example.org" })) === 403, "and cannot pause the run");
  assert((await status(`${address}scene`, "GET", { Host: "example.org" })) === 403, "nor by another name of this machine");
  assert(wrong.length === 0, `no other request and no error${wrong.length ? `: ${wrong.join("; ")}` : ""}`);

  await close();
  close = async () => {};
  await new Promise((done) => setTimeout(done, 300));
  assert(run.process.exitCode === null, "closing the page does not end the run");
  run.process.kill("SIGINT");
  await Promise.race([run.ended, new Promise((_, failed) => setTimeout(() => failed(new Error("the run does not end")), 15_000))]);
  assert(run.process.exitCode === 130, "an interrupt ends the run and its server");
  const frames = () => Number(/frames +(\d+)/.exec(execFileSync(gotai, ["info", recording], { encoding: "utf8" }))?.[1]);
  assert(frames() > 2, "its recording can be read");
  await kill(frames);
} catch (error) {
  console.error(error.message, wrong.join("; "));
  process.exitCode = 1;
} finally {
  run.process.kill("SIGKILL");
  await close();
  rmSync(folder, { recursive: true, force: true });
}
