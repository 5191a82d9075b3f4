// Helpers of the page's tests: the server, the browser, and a page whose errors are recorded.

import assert from "node:assert/strict";
import { execFile, spawn } from "node:child_process";
import { once } from "node:events";
import { existsSync } from "node:fs";
import { mkdtemp, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import path from "node:path";
import { test } from "node:test";
import { setTimeout as delay } from "node:timers/promises";
import { fileURLToPath } from "node:url";
import { promisify } from "node:util";
import { inflateRawSync } from "node:zlib";
import { chromium } from "playwright-core";

const run = promisify(execFile);

const here = path.dirname(fileURLToPath(import.meta.url));
/** The folder that web/build has made. */
export const DIST = process.env.TILESCOPE_DIST ?? path.join(here, "../dist");
/** The native program's path. */
export const PROGRAM = process.env.TILESCOPE ?? path.join(here, "../../target/release/tilescope");

/** Whether all cases are tested, also those that take long and rarely break: TILESCOPE_SLOW=1, as `tests/run --slow` sets it. */
export const IS_SLOW = Boolean(process.env.TILESCOPE_SLOW);

/**
 * Declares a test that takes long and rarely breaks.
 * @param {string} name
 * @param {(t: import("node:test").TestContext) => Promise<void>} run
 */
export function slowTest(name, run) {
  test(name, { skip: !IS_SLOW && "takes long: tests/run --slow runs it" }, run);
}

/** A timeout long enough for software renderers on a busy machine. */
export const PATIENCE_MS = 300_000;

/**
 * WebGPU and WebGL without a GPU, and no request of the browser's own. Chromium ends the process that draws when it does not
 * answer for seconds, which a software renderer on a busy machine may not; all pages would lose their displays.
 */
const FLAGS = [
  "--no-sandbox",
  "--disable-gpu-watchdog",
  "--use-angle=swiftshader",
  "--enable-unsafe-swiftshader",
  "--enable-unsafe-webgpu",
  "--ignore-gpu-blocklist",
  "--enable-features=Vulkan",
  "--use-vulkan=swiftshader",
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
];

/** Returns the path of the browser, found as by a shell. */
function browserPath() {
  const named = process.env.TILESCOPE_CHROMIUM;
  const names = named ? [named] : ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];
  const folders = (process.env.PATH ?? "").split(path.delimiter);
  const paths = names.flatMap((name) => (name.includes(path.sep) ? [name] : folders.map((at) => path.join(at, name))));
  const found = paths.find((file) => existsSync(file));
  assert.ok(found, `no browser: there is no ${names.join(", ")}`);
  return found;
}

/** Starts the browser. @param {string[]} flags more of its flags */
export function launch(flags = []) {
  return chromium.launch({ executablePath: browserPath(), args: [...FLAGS, ...flags] });
}

/**
 * Serves a folder by `tilescope web` on a free port. Returns its address and a function that ends the server.
 * @param {string} folder
 * @param {number} port
 */
export async function serve(folder = DIST, port = 0) {
  assert.ok(existsSync(path.join(folder, "index.html")), `${folder} holds no page: run web/build`);
  const server = spawn(PROGRAM, ["web", "--port", String(port), "--folder", folder], {
    stdio: ["ignore", "pipe", "inherit"],
  });
  let said = "";
  for await (const part of server.stdout) {
    said += part;
    const address = said.match(/http:\/\/[0-9.]+:[0-9]+/);
    if (address) {
      const stop = async () => {
        server.kill("SIGINT");
        await once(server, "exit");
      };
      return { address: address[0], stop };
    }
  }
  throw new Error(`no address from ${PROGRAM} web: ${said}`);
}

/** Within the canvas of the layout for desktops. */
export const MIDDLE = { x: 420, y: 200, width: 400, height: 350 };

/** Repeats an attempt until it returns a value, and returns that. @template T @param {string} what @param {() => Promise<T>} attempt */
export async function until(what, attempt) {
  const end = Date.now() + PATIENCE_MS;
  for (;;) {
    const found = await attempt();
    if (found) {
      return found;
    }
    assert.ok(Date.now() < end, `it was waited for in vain: ${what}`);
    await delay(50);
  }
}

/**
 * Waits until a page shows a picture, with more than a few colours and some contrast, and returns its mean brightness.
 * A frame may be drawn after its state was reported.
 * @param {import("playwright-core").Page} page
 */
export async function shows(page, clip = MIDDLE) {
  return until("a picture", async () => {
    const { mean, variance, colours } = await pixels(page, clip);
    return variance > 100 && colours > 50 ? mean : undefined;
  });
}

/** Waits until a page looks the same twice, and returns the picture. @param {import("playwright-core").Page} page */
export async function rests(page) {
  let before = await page.screenshot();
  return until("a picture that stays", async () => {
    const now = await page.screenshot();
    const same = now.equals(before);
    before = now;
    return same ? now : undefined;
  });
}

/**
 * Waits until a part of a page differs from a picture, and returns the new picture.
 * @param {import("playwright-core").Page} page
 * @param {Buffer} before
 */
export async function changed(page, before, clip = MIDDLE) {
  return until("another picture", async () => {
    const now = await page.screenshot({ clip });
    return now.equals(before) ? undefined : now;
  });
}

/** Runs the native program and returns what it prints. @param {string[]} args */
export async function native(...args) {
  const { stdout } = await run(PROGRAM, args, { maxBuffer: 64_000_000 });
  return stdout;
}

/** Returns a folder that is removed after the test. @param {import("node:test").TestContext} t */
export async function folder(t) {
  const made = await mkdtemp(path.join(tmpdir(), "tilescope-web-"));
  t.after(() => rm(made, { recursive: true, force: true }));
  return made;
}

/**
 * Records errors on the pages of a context, and requests to other than the given origins.
 * @param {import("playwright-core").BrowserContext} context
 * @param {string[]} origins
 */
export function watch(context, origins) {
  /** @type {string[]} */
  const wrong = [];
  context.on("console", (message) => {
    if (["error", "warning"].includes(message.type()) && !isOfTheBrowser(message.text())) {
      wrong.push(`console: ${message.text()}`);
    }
  });
  context.on("weberror", (error) => {
    // The scripts of tests also run on the initial empty page, which has no WebGPU.
    if (error.page()?.url() !== "about:blank") {
      wrong.push(`page: ${error.error().stack ?? error.error()}`);
    }
  });
  context.on("request", (request) => {
    const { origin, protocol } = new URL(request.url());
    if (!origins.includes(origin) && !["data:", "blob:"].includes(protocol)) {
      wrong.push(`request: ${request.url()}`);
    }
  });
  return wrong;
}

/**
 * Asserts that exactly the expected errors occurred.
 * @param {string[]} wrong
 * @param {RegExp[]} expected
 */
export function nothingElse(wrong, expected) {
  const others = wrong.filter((line) => !expected.some((pattern) => pattern.test(line)));
  assert.deepEqual(others, []);
  for (const pattern of expected) {
    assert.ok(wrong.some((line) => pattern.test(line)), `${pattern} was expected of ${JSON.stringify(wrong)}`);
  }
}

/**
 * Prints the errors of pages if the test has failed, as they may be the reason.
 * @param {import("node:test").TestContext} t
 * @param {string[]} wrong
 */
export function tellIfFailed(t, wrong) {
  if (!t.passed) {
    t.diagnostic(wrong.join("\n") || "there were no errors on the pages");
  }
}

/**
 * Returns whether a warning comes from a software renderer, or from eframe's canvas about letters that no font has.
 * @param {string} text
 */
function isOfTheBrowser(text) {
  return /GPU stall due to ReadPixels|Canvas2D: Multiple readback operations|Automatic fallback to software WebGL|powerPreference option is currently ignored/.test(text);
}

/** Waits until the program runs on a page, and its session is there and drawn. @param {import("playwright-core").Page} page */
export async function ready(page, clip = MIDDLE) {
  await state(page, (told) => told.ready && told.verified !== null);
  assert.equal(await page.isHidden("#loading"), true);
  await shows(page, clip);
}

/** Sends a request to the program on a page. @param {import("playwright-core").Page} page @param {object} request */
export async function ask(page, request) {
  const answer = await page.evaluate((text) => window.tilescope.ask(text), JSON.stringify(request));
  return JSON.parse(answer);
}

/**
 * Waits for a state of the program on a page, and returns it.
 * @param {import("playwright-core").Page} page
 * @param {(told: any) => boolean} wished
 */
export async function state(page, wished = () => true) {
  return until("a state as wished", async () => {
    const failed = await page.evaluate(() => document.getElementById("failure")?.hidden === false);
    assert.ok(!failed, "the page has failed: " + (await page.textContent("#failure-text")));
    if (!(await page.evaluate(() => Boolean(window.tilescope)))) {
      return undefined;
    }
    const told = (await ask(page, { do: "state" })).state;
    return told && wished(told) ? told : undefined;
  });
}

/**
 * Opens a link on a page, and returns the state once its run is made and verified.
 * @param {import("playwright-core").Page} page
 * @param {string} link
 */
export async function load(page, link) {
  const { ok, dropped } = await ask(page, { do: "load", link });
  assert.deepEqual([ok, dropped], [true, []]);
  return state(page, (told) => told.ready && told.verified !== null);
}

/** Waits until a text field accepts typing. @param {import("playwright-core").Page} page */
export async function typing(page) {
  await page.waitForFunction(() => document.activeElement?.tagName === "INPUT", null, { timeout: PATIENCE_MS });
}

/** Returns mean and variance of the brightness of a part of a page, and how many colours it has. @param {import("playwright-core").Page} page @param {{x: number, y: number, width: number, height: number}} clip */
export async function pixels(page, clip) {
  const png = await page.screenshot({ clip });
  return page.evaluate(async (base64) => {
    const bytes = Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));
    const picture = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
    const context = new OffscreenCanvas(picture.width, picture.height).getContext("2d");
    context.drawImage(picture, 0, 0);
    const { data } = context.getImageData(0, 0, picture.width, picture.height);
    let [sum, squares] = [0, 0];
    const colours = new Set();
    for (let k = 0; k < data.length; k += 4) {
      const light = (data[k] + data[k + 1] + data[k + 2]) / 3;
      sum += light;
      squares += light * light;
      colours.add((data[k] << 16) | (data[k + 1] << 8) | data[k + 2]);
    }
    const count = data.length / 4;
    const mean = sum / count;
    return { mean, variance: squares / count - mean * mean, colours: colours.size };
  }, png.toString("base64"));
}

/** Returns the files of an archive whose entries are not compressed. @param {Buffer} archive */
export function stored(archive) {
  return unpacked(archive).map(({ name, method, bytes }) => {
    assert.equal(method, 0, "the entry is compressed");
    return { name, bytes };
  });
}

/** Returns the files of an archive, each with the method of its compression. @param {Buffer} archive */
export function unpacked(archive) {
  const files = [];
  let at = 0;
  while (archive.readUInt32LE(at) === 0x04034b50) {
    const method = archive.readUInt16LE(at + 8);
    const size = archive.readUInt32LE(at + 18);
    const name = archive.readUInt16LE(at + 26);
    const start = at + 30 + name + archive.readUInt16LE(at + 28);
    const packed = archive.subarray(start, start + size);
    const bytes = method === 0 ? packed : inflateRawSync(packed);
    files.push({ name: archive.toString("utf8", at + 30, at + 30 + name), method, bytes });
    at = start + size;
  }
  return files;
}
