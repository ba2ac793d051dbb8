// A headless Chromium for the tests of real pages.
import { existsSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { chromium } from "playwright-core";

export const kSkip = 77; // what ctest takes for "skipped"

/** Where Debian and others put it; GOTAI_CHROMIUM names another place. */
export function findChromium() {
  const places = [process.env.GOTAI_CHROMIUM, "/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
  return places.find((path) => path && existsSync(path));
}

export function assert(condition, what) {
  if (!condition) throw new Error(`failed: ${what}`);
  console.log(`ok: ${what}`);
}

/**
 * Opens a page and watches it. `allowed` says which addresses it may ask for.
 * Returns the page, what it did wrong so far, and a function that closes everything.
 */
export async function openPage(url, allowed) {
  const folder = mkdtempSync(join(tmpdir(), "gotai-browser-"));
  const context = await chromium.launchPersistentContext(folder, {
    executablePath: findChromium(),
    headless: true,
    viewport: { width: 1280, height: 760 },
    colorScheme: "light",
    acceptDownloads: true,
    args: [
      "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
      "--disable-background-networking", "--disable-component-update", "--disable-sync",
      "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    ],
  });
  const page = context.pages()[0] ?? (await context.newPage());
  const wrong = [];
  page.on("request", (request) => {
    if (!allowed(request.url())) wrong.push(`request to ${request.url()}`);
  });
  page.on("console", (message) => {
    if (message.type() === "error") wrong.push(`console: ${message.text()}`);
  });
  page.on("pageerror", (error) => wrong.push(`page: ${error.message}`));
  await page.goto(url);
  const close = async () => {
    await context.close();
    rmSync(folder, { recursive: true, force: true, maxRetries: 5 });
  };
  return { page, wrong, close };
}

/** Pixels of the middle of the page, where no panel lies: red, green, blue, alpha. */
export async function grab(page) {
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  const png = await page.screenshot({ clip: { x: 300, y: 80, width: 600, height: 560 } });
  const values = await page.evaluate(async (text) => {
    const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    const image = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
    const canvas = new OffscreenCanvas(image.width, image.height);
    const context = canvas.getContext("2d");
    context.drawImage(image, 0, 0);
    const pixels = context.getImageData(0, 0, image.width, image.height).data;
    return new Promise((done) => {
      const reader = new FileReader();
      reader.onload = () => done(reader.result.split(",")[1]);
      reader.readAsDataURL(new Blob([pixels]));
    });
  }, png.toString("base64"));
  return Buffer.from(values, "base64");
}

/** Number of pixels that differ visibly. */
export function changed(a, b) {
  let count = 0;
  for (let i = 0; i < a.length; i += 4)
    if (Math.abs(a[i] - b[i]) + Math.abs(a[i + 1] - b[i + 1]) + Math.abs(a[i + 2] - b[i + 2]) > 24) ++count;
  return count;
}

/** Number of different colours, coarsely. A blank or plain picture has few. */
export function colours(pixels) {
  const seen = new Set();
  for (let i = 0; i < pixels.length; i += 4)
    seen.add(((pixels[i] >> 4) << 8) | ((pixels[i + 1] >> 4) << 4) | (pixels[i + 2] >> 4));
  return seen.size;
}
