// node report.mjs GOTAI FOLDER: the report of all experiments opens offline, shows every figure by
// its number and plays an animation. Finished points in FOLDER are used again. Run by .ci/run, after
// the experiments: they take minutes.
import { spawnSync } from "node:child_process";
import { existsSync } from "node:fs";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { assert, findChromium, kSkip, openPage } from "./browser.mjs";

if (!findChromium()) {
  console.log("skipped: no chromium here (apt-get install chromium, or set GOTAI_CHROMIUM)");
  process.exit(kSkip);
}
const [gotai, folder] = process.argv.slice(2);
const kMissed = 4; // some number did not come out: judged elsewhere, the report is there

// The figures that chapters 2 to 6 of the thesis have.
const range = (chapter, from, to) =>
  Array.from({ length: to - from + 1 }, (_, k) => `Fig. ${chapter}-${from + k}`);
const figures = [...range(2, 1, 2), ...range(3, 1, 6), ...range(4, 1, 10), ...range(5, 1, 6), ...range(6, 1, 29)];

const run = spawnSync(gotai, ["experiment", "all", "--quick", "-o", folder], { stdio: ["ignore", "ignore", "inherit"] });
assert(run.status === 0 || run.status === kMissed, `gotai experiment all --quick ends in order (${run.status})`);
const report = resolve(join(folder, "report.html"));
assert(existsSync(report), "there is one report");

const { page, wrong, close } = await openPage(pathToFileURL(report).href, (url) => /^(file|data|blob|about):/.test(url));
try {
  const shown = await page.$$eval("figcaption, figure svg text", (nodes) => nodes.map((node) => node.textContent));
  const missing = figures.filter((figure) => !shown.some((text) => text.startsWith(`${figure}:`)));
  assert(missing.length === 0, `every figure is there by its number (missing: ${missing.join(", ") || "none"})`);
  const pictures = await page.$$eval("figure img", (images) => images.map((image) => image.naturalWidth));
  assert(pictures.length > 0 && pictures.every((width) => width > 0), `${pictures.length} pictures are drawn`);
  if (await page.$(".animation button")) {
    await page.click(".animation button");
    const frame = await (await page.waitForSelector(".animation iframe")).contentFrame();
    await frame.waitForSelector("canvas");
    await frame.waitForFunction(() => Number(document.documentElement.dataset.time) >= 0);
    assert(true, "an animation opens in the viewer");
  }
  assert(wrong.length === 0, `no console errors, nothing from elsewhere (${wrong.join("; ") || "none"})`);
} finally {
  await close();
}
