// node recorded.mjs GOTAI SCENE.toml: simulates, makes the page, and uses it like a reader.
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, statSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { assert, changed, colours, findChromium, grab, kSkip, openPage } from "./browser.mjs";

if (!findChromium()) {
  console.log("skipped: no chromium here (apt-get install chromium, or set GOTAI_CHROMIUM)");
  process.exit(kSkip);
}
const [gotai, scene] = process.argv.slice(2);
const folder = mkdtempSync(join(tmpdir(), "gotai-view-"));

async function seek(page, part) {
  await page.$eval("#time", (bar, f) => {
    bar.value = String(Number(bar.min) + f * (Number(bar.max) - Number(bar.min)));
    bar.dispatchEvent(new Event("input"));
  }, part);
  const time = await page.$eval("#time", (bar) => Number(bar.value));
  await page.waitForFunction((t) => Math.abs(Number(document.documentElement.dataset.time) - t) < 1e-4, time);
  return time;
}

const chartState = (page) =>
  page.$$eval(".charts section", (sections) =>
    sections.map((s) => ({
      title: s.dataset.chart,
      marker: s.querySelector(".marker").style.transform,
      values: [...s.querySelectorAll("header b")].map((b) => b.textContent).join(" "),
    })));

async function watch(page) {
  const moments = [];
  const charts = [];
  for (const part of [0.1, 0.5, 0.9]) {
    await seek(page, part);
    moments.push(await grab(page));
    charts.push(await chartState(page));
  }
  moments.forEach((pixels, i) => assert(colours(pixels) > 40, `moment ${i + 1} is no blank picture (${colours(pixels)} colours)`));
  assert(changed(moments[0], moments[1]) > 300 && changed(moments[1], moments[2]) > 100, "the bodies move");
  for (const title of ["Energy", "Contacts", "Overlap", "Time per step"]) {
    const [a, b, c] = charts.map((state) => state.find((chart) => chart.title === title));
    assert(a && a.marker !== b.marker && b.marker !== c.marker, `the chart ${title} follows the time bar`);
    assert(a.values !== c.values, `the numbers of the chart ${title} follow, too`);
  }
}

async function toggle(page) {
  await seek(page, 0.9);
  for (const name of ["walls", "contacts", "apparent", "centres", "trails", "translucent", "voxels"]) {
    const before = await grab(page);
    await page.click(`#toggle-${name}`);
    const difference = changed(before, await grab(page));
    assert(difference > 20, `the toggle ${name} changes the picture (${difference} pixels)`);
    await page.click(`#toggle-${name}`);
    assert(changed(before, await grab(page)) < 20, `and the toggle ${name} brings it back`);
  }
  await page.keyboard.press("v");
  const fine = await grab(page);
  await page.keyboard.press(",");
  assert(changed(fine, await grab(page)) > 100, "a coarser level looks different");
  await page.keyboard.press("v");
  let last = await grab(page);
  for (const mode of ["speed", "impulse", "index", "material"]) {
    await page.click(`#colour-${mode}`);
    const next = await grab(page);
    assert(changed(last, next) > 100, `the colour ${mode} changes the picture`);
    last = next;
  }
  await page.keyboard.press("d");
  assert(changed(last, await grab(page)) > 10000, "the dark theme is dark");
  await page.keyboard.press("d");
}

async function handle(page) {
  await seek(page, 0.2);
  await page.keyboard.press("ArrowRight");
  await page.waitForFunction((t) => Number(document.documentElement.dataset.time) > t,
    await page.$eval("#time", (bar) => Number(bar.min) + 0.2 * (Number(bar.max) - Number(bar.min))));
  const before = await page.$eval("html", (html) => Number(html.dataset.time));
  await page.keyboard.press("Space");
  await page.waitForFunction((t) => Number(document.documentElement.dataset.time) > t + 0.03, before);
  await page.keyboard.press("Space");
  assert(true, "arrow and space step and play");

  await page.keyboard.press("h");
  assert(await page.isVisible(".help"), "H shows the help");
  await page.keyboard.press("Escape");
  assert(!(await page.isVisible(".help")), "Esc closes it");

  await seek(page, 0.9);
  for (let y = 620; y > 200 && !(await page.isVisible(".inspector")); y -= 40)
    for (let x = 420; x < 800 && !(await page.isVisible(".inspector")); x += 40) await page.mouse.click(x, y);
  assert(await page.isVisible(".inspector"), "a click on a body shows its numbers");
  assert(/kg/.test(await page.innerText(".inspector")), "its mass among them");
  await page.keyboard.press("Escape");

  await grab(page); // until the charts lie where they stay
  const overlay = page.locator(".charts section .u-over").first();
  let chart = await overlay.boundingBox();
  for (let last = null; JSON.stringify(chart) !== JSON.stringify(last); ) {
    last = chart;
    await page.waitForTimeout(300);
    chart = await overlay.boundingBox();
  }
  await page.mouse.click(chart.x + chart.width / 4, chart.y + chart.height / 2);
  // The time bar follows with the next picture.
  await page.waitForFunction(() => {
    const bar = document.querySelector("#time");
    return Math.abs(Number(bar.value) - Number(bar.max) / 4) < Number(bar.max) / 20;
  }, undefined, { timeout: 10000 }).catch(() => {});
  const [time, end] = await page.$eval("#time", (bar) => [Number(bar.value), Number(bar.max)]);
  assert(Math.abs(time - end / 4) < end / 20, "a click on a chart seeks");

  const view = await grab(page);
  await page.mouse.move(640, 400);
  await page.mouse.down();
  await page.mouse.move(760, 420, { steps: 4 });
  await page.mouse.up();
  await page.waitForTimeout(500);
  assert(changed(view, await grab(page)) > 1000, "dragging turns the camera");

  const download = page.waitForEvent("download");
  await page.keyboard.press("s");
  const picture = readFileSync(await (await download).path());
  assert(picture.subarray(1, 4).toString() === "PNG" && picture.length > 5000, "S saves a picture");
}

let page;
let wrong = [];
let close = async () => {};
try {
  const run = join(folder, "run.h5");
  const html = join(folder, "run.html");
  execFileSync(gotai, ["run", scene, "-o", run], { stdio: "inherit" });
  execFileSync(gotai, ["view", run, "-o", html], { stdio: "inherit" });
  assert(statSync(html).size < 3e6, "the page is small");
  const allowed = (url) => /^(file|data|blob):/.test(url);
  ({ page, wrong, close } = await openPage(pathToFileURL(html).href, allowed));
  page.setDefaultTimeout(60_000);
  await page.waitForSelector("html[data-ready]");
  await watch(page);
  await toggle(page);
  await handle(page);
  assert(wrong.length === 0, `no request to the network and no error${wrong.length ? `: ${wrong.join("; ")}` : ""}`);
} catch (error) {
  console.error(error.message, wrong.join("; "));
  if (page) await page.screenshot({ path: join(tmpdir(), "gotai-view-failed.png") }).catch(() => {});
  process.exitCode = 1;
} finally {
  await close();
  rmSync(folder, { recursive: true, force: true });
}
