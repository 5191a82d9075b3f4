// The page begins: it shows the default session, verified, by either display, and says what it lacks where it cannot.

import assert from "node:assert/strict";
import { test } from "node:test";
import { PATIENCE_MS, ask, changed, pixels, rests, shows, state, until } from "./harness.mjs";
import { contextOf, opened, started } from "./shared.mjs";

/** The whole page. */
const WHOLE = { x: 0, y: 0, width: 1280, height: 800 };

/** Asserts that a picture of the page is loaded and seen. @param {import("playwright-core").Page} page @param {string} at */
async function pictured(page, at) {
  const image = page.locator(at);
  await image.scrollIntoViewIfNeeded();
  await shows(page, await image.boundingBox());
}

for (const [display, name] of [["webgpu", "WebGPU"], ["webgl", "WebGL 2"]]) {
  test(`the default session is shown and verified by ${name}`, async (t) => {
    const { page } = await started(t, `?display=${display}`);
    const told = await state(page);
    assert.equal(told.verified, true);
    assert.equal(told.seed, 1);
    assert.ok(told.samples > 9_000 && told.samples < 11_000, `${told.samples} samples`);
    assert.ok(told.events > 40_000, `${told.events} events`);
    assert.equal(await page.evaluate(() => window.tilescope.display()), name);
    assert.match(told.chosen, new RegExp(name));
  });
}

test("the first frame comes soon after the load, and the page is idle when nothing happens", async (t) => {
  const { page } = await started(t);
  // A figure to be read, not a limit to be met: machines differ.
  const marks = await page.evaluate(() => performance.getEntriesByType("mark").map((mark) => [mark.name, mark.startTime]));
  const first = new Map(marks).get("tilescope: first frame");
  assert.ok(first > 0, `no mark of the first frame among ${JSON.stringify(marks)}`);
  t.diagnostic(`first interactive frame ${Math.round(first)} ms after navigation`);
  // Once all is computed, nothing is drawn.
  await state(page, (told) => told.gpu !== "testing");
  await page.mouse.move(5, 795);
  await page.waitForTimeout(3_000);
  const drawn = (ms) =>
    page.evaluate(async (ms) => {
      let count = 0;
      const { submit } = GPUQueue.prototype;
      const { drawElements } = WebGL2RenderingContext.prototype;
      GPUQueue.prototype.submit = function (...given) {
        count += 1;
        return submit.apply(this, given);
      };
      WebGL2RenderingContext.prototype.drawElements = function (...given) {
        count += 1;
        return drawElements.apply(this, given);
      };
      await new Promise((resolve) => setTimeout(resolve, ms));
      GPUQueue.prototype.submit = submit;
      WebGL2RenderingContext.prototype.drawElements = drawElements;
      return count;
    }, ms);
  assert.equal(await drawn(2_000), 0, "it draws while nothing happens");
  // What draws would be counted.
  const [count] = await Promise.all([drawn(3_000), ask(page, { do: "seek", part: 0.5 })]);
  assert.ok(count > 0);
});

test("a browser without WebAssembly is told so, with a picture", async (t) => {
  const { page } = await opened(t, "", {
    prepare: (context) => context.addInitScript(() => delete globalThis.WebAssembly),
  });
  await page.waitForSelector("#missing:not([hidden])");
  assert.match(await page.textContent("#missing-list"), /WebAssembly/);
  await pictured(page, "#missing img");
  assert.equal(await page.isVisible("#canvas"), false);
});

test("a browser without WebGL 2 and WebGPU is told so, with a picture", async (t) => {
  const takeDisplays = () => {
    HTMLCanvasElement.prototype.getContext = () => null;
    Object.defineProperty(Navigator.prototype, "gpu", { value: undefined });
  };
  const { page } = await opened(t, "", { prepare: (context) => context.addInitScript(takeDisplays) });
  await page.waitForSelector("#missing:not([hidden])");
  assert.match(await page.textContent("#missing-list"), /neither WebGL 2 nor WebGPU/);
  await pictured(page, "#missing img");
});

test("without scripts the page says that it needs them", async (t) => {
  const { page } = await opened(t, "", { settings: { javaScriptEnabled: false } });
  await page.waitForSelector("noscript h2", { state: "visible" });
  assert.match(await page.textContent("noscript h2"), /needs JavaScript/);
  await pictured(page, "noscript img");
});

test("a module that cannot be had is said", async (t) => {
  const { page } = await opened(t, "", {
    prepare: (context) => context.route(/sheets-/, (route) => route.abort()),
    expected: [/Failed to load resource/],
  });
  await page.waitForSelector("#failure:not([hidden])");
  assert.match(await page.textContent("#failure-text"), /cannot be loaded/);
  assert.equal(await page.isHidden("#loading"), true);
  await shows(page, await page.locator("#failure .card").boundingBox());
});

test("a worker that cannot be had is said", async (t) => {
  const { page } = await opened(t, "?engine=cpu", {
    prepare: (context) => context.route(/worker-/, (route) => route.abort()),
  });
  const told = await state(page, (told) => told.notice !== null);
  assert.match(told.notice, /script|worker/);
  await shows(page, WHOLE);
});

test("where WebGPU does not start WebGL 2 draws, and says why", async (t) => {
  const takeDevices = () => {
    GPUAdapter.prototype.requestDevice = () => Promise.reject(new DOMException("no device", "OperationError"));
  };
  const { page } = await started(t, "?engine=cpu#v=1&radius=0.02", {
    prepare: (context) => context.addInitScript(takeDevices),
  });
  assert.equal(await page.evaluate(() => window.tilescope.display()), "WebGL 2");
  assert.match((await state(page)).notice, /WebGPU did not start/);
});

test("keys that mean something here are not the browser's, others are", async (t) => {
  const { page } = await started(t, "?engine=cpu#v=1&radius=0.02");
  const kept = (key, ctrlKey = false) =>
    page.evaluate(
      ([key, ctrlKey]) => {
        const event = new KeyboardEvent("keydown", { key, ctrlKey, bubbles: true, cancelable: true });
        return !document.getElementById("canvas").dispatchEvent(event);
      },
      [key, ctrlKey],
    );
  for (const [key, ctrl] of [["F5"], ["F10"], ["F11"], ["k", true], ["e", true], ["s", true]]) {
    assert.equal(await kept(key, ctrl), true, key);
  }
  for (const [key, ctrl] of [["F12"], ["r", true], ["c", true], ["t", true], ["F6"]]) {
    assert.equal(await kept(key, ctrl), false, key);
  }
});

test("loading shows how much has come", async (t) => {
  const { server, context } = await contextOf(t);
  const page = await context.newPage();
  const session = await context.newCDPSession(page);
  await session.send("Network.enable");
  const bytes = { downloadThroughput: 200_000, uploadThroughput: -1 };
  await session.send("Network.emulateNetworkConditions", { offline: false, latency: 0, ...bytes });
  await page.goto(`${server.address}/`, { waitUntil: "commit" });
  const bar = page.locator("#loading-bar");
  const beyond = (least) =>
    until(`more than ${least} of the bar`, async () => {
      const share = Number((await bar.getAttribute("value")) ?? 0);
      return share > least ? share : undefined;
    });
  const begun = await beyond(0);
  const clip = await bar.boundingBox();
  const { mean } = await pixels(page, clip);
  const later = await beyond(begun + 0.2);
  assert.ok(begun < 1 && later <= 1, `${begun}, then ${later}`);
  assert.ok((await pixels(page, clip)).mean > mean, "the bar does not fill");
  assert.match(await page.textContent("#loading-size"), /^\d+\.\d of \d+\.\d MB, \d+%$/);
});

test("the page can be installed: its manifest is sound, and its icons are of the sizes that it tells", async (t) => {
  const { context, page } = await started(t, "?engine=cpu#v=1&radius=0.02");
  const session = await context.newCDPSession(page);
  const { errors } = await session.send("Page.getAppManifest");
  assert.deepEqual(errors, []);
  const { manifest, icons } = await page.evaluate(async () => {
    const { href } = document.querySelector("link[rel=manifest]");
    const manifest = await (await fetch(href)).json();
    const icons = manifest.icons.map(async ({ src, sizes, purpose }) => {
      const picture = await createImageBitmap(await (await fetch(new URL(src, href))).blob());
      return { told: sizes, is: `${picture.width}x${picture.height}`, purpose: purpose ?? "any" };
    });
    return { manifest, icons: await Promise.all(icons) };
  });
  assert.deepEqual([manifest.name, manifest.display, manifest.start_url], ["Tilescope", "standalone", "./"]);
  assert.deepEqual(icons.map(({ is }) => is), icons.map(({ told }) => told));
  for (const purpose of ["any", "maskable"]) {
    const sizes = icons.filter((icon) => icon.purpose === purpose).map(({ is }) => is);
    assert.deepEqual(sizes, ["192x192", "512x512"], purpose);
  }
});

/** Has a page note each picture that the program draws, twenty of them a second by its clock, however long they take. */
function film() {
  let now_ms = performance.now();
  performance.now = () => now_ms;
  window.film = new Set();
  const original = window.requestAnimationFrame;
  window.requestAnimationFrame = (callback) =>
    original.call(window, () => {
      now_ms += 50;
      callback(now_ms);
      const small = new OffscreenCanvas(100, 90).getContext("2d");
      small.drawImage(document.getElementById("canvas"), 420, 200, 400, 350, 0, 0, 100, 90);
      const { data } = small.getImageData(0, 0, 100, 90);
      // Where nothing was drawn there is nothing to be had.
      if (data.some((value) => value > 0)) {
        window.film.add(data.join());
      }
    });
}

for (const reducedMotion of ["reduce", "no-preference"]) {
  const jumps = reducedMotion === "reduce";
  test(`the camera ${jumps ? "jumps where motion is to be reduced" : "flies where motion is welcome"}`, async (t) => {
    const { page } = await started(t, "?engine=cpu&display=webgl#v=1&radius=0.02&camera=20,20,40", {
      settings: { reducedMotion },
      prepare: (context) => context.addInitScript(film),
    });
    await page.mouse.move(5, 795);
    await page.evaluate(() => window.film.clear());
    await page.keyboard.press("f");
    await state(page, (told) => !told.link.includes("camera"));
    // Longer than a flight, by the page's clock.
    const start_ms = await page.evaluate(() => performance.now());
    await page.waitForFunction((start_ms) => performance.now() > start_ms + 2_000, start_ms, { timeout: PATIENCE_MS });
    const pictures = await page.evaluate(() => window.film.size);
    assert.ok(jumps ? pictures <= 2 : pictures > 6, `${pictures} pictures`);
    await shows(page);
  });
}

test("the system's wish for less motion counts from the moment it changes", async (t) => {
  const { page } = await started(t, "?engine=cpu&display=webgl#v=1&radius=0.02&camera=20,20,40", {
    settings: { reducedMotion: "no-preference" },
    prepare: (context) => context.addInitScript(film),
  });
  await page.emulateMedia({ reducedMotion: "reduce" });
  await page.waitForFunction(() => matchMedia("(prefers-reduced-motion: reduce)").matches);
  await page.mouse.move(5, 795);
  await page.evaluate(() => window.film.clear());
  await page.keyboard.press("f");
  await state(page, (told) => !told.link.includes("camera"));
  const start_ms = await page.evaluate(() => performance.now());
  await page.waitForFunction((start_ms) => performance.now() > start_ms + 2_000, start_ms, { timeout: PATIENCE_MS });
  const pictures = await page.evaluate(() => window.film.size);
  assert.ok(pictures <= 2, `${pictures} pictures`);
});

test("where the keyboard is can be seen", async (t) => {
  const { page } = await started(t, "?engine=cpu#v=1&radius=0.02");
  for (let k = 0; k < 3; k += 1) {
    const before = await rests(page);
    await page.keyboard.press("Tab");
    await changed(page, before, WHOLE);
  }
});
