// The page starts: it shows the default session, verified, with either display, and names what is missing if it cannot.

import assert from "node:assert/strict";
import { once } from "node:events";
import { createServer } from "node:http";
import { test } from "node:test";
import { PATIENCE_MS, ask, changed, load, pixels, rests, shows, slowTest, state, until } from "./harness.mjs";
import { host, opened, reused, started, visitedBefore } from "./shared.mjs";

/** The whole page. */
const WHOLE = { x: 0, y: 0, width: 1280, height: 800 };

/** Asserts that a picture of the page is loaded and visible. @param {import("playwright-core").Page} page @param {string} at */
async function pictured(page, at) {
  const image = page.locator(at);
  await image.scrollIntoViewIfNeeded();
  await shows(page, await image.boundingBox());
}

for (const [display, name] of [["webgpu", "WebGPU"], ["webgl", "WebGL 2"]]) {
  test(`the default session is shown and verified by ${name}`, async (t) => {
    const { page } = await started(t, `?engine=cpu&display=${display}`, { settings: { deviceScaleFactor: 1 } });
    const told = await state(page);
    assert.equal(told.verified, true);
    assert.equal(told.seed, 1);
    assert.ok(told.samples > 9_000 && told.samples < 11_000, `${told.samples} samples`);
    assert.ok(told.events > 40_000, `${told.events} events`);
    assert.equal(await page.evaluate(() => window.tilescope.display()), name);
    assert.match(told.chosen, new RegExp(name));
  });
}

test("a first visit begins with the tour, which Escape ends; a link and a later visit do not", async (t) => {
  const { page, server, context } = await started(t, "?engine=cpu", { first: true });
  const touring = await state(page, (told) => told.caption !== null);
  assert.match(touring.caption, /maximal|closer than one radius/);
  await page.focus("#canvas");
  await page.keyboard.press("Space");
  const next = await state(page, (told) => told.caption !== touring.caption);
  assert.equal(next.stage, "pattern");
  await page.keyboard.press("Escape");
  await state(page, (told) => told.caption === null);
  for (const [address, keep] of [["#v=1&radius=0.02", false], ["", true]]) {
    if (keep) {
      await page.evaluate(visitedBefore);
    }
    const other = await context.newPage();
    await other.goto(`${server.address}/?engine=cpu${address}`);
    assert.equal((await state(other, (told) => told.ready)).caption, null);
    await other.close();
  }
});

/** Advances the page's clock by 50 ms for each of its frames, however long they take, and counts draws. */
function slowClock() {
  let now_ms = performance.now();
  performance.now = () => now_ms;
  const { requestAnimationFrame } = window;
  window.requestAnimationFrame = (callback) =>
    requestAnimationFrame.call(window, () => {
      now_ms += 50;
      callback(now_ms);
      window.filmed?.();
    });
  window.drawn = 0;
  const counted = (prototype, name) => {
    const original = prototype[name];
    prototype[name] = function (...given) {
      window.drawn += 1;
      return original.apply(this, given);
    };
  };
  counted(GPUQueue.prototype, "submit");
  counted(WebGL2RenderingContext.prototype, "drawElements");
}

test("the first frame comes soon after the load, and the page is idle when nothing happens", async (t) => {
  const { page } = await started(t, "?play", { prepare: (context) => context.addInitScript(slowClock) });
  // Printed only, without a limit, since machines differ.
  const marks = await page.evaluate(() => performance.getEntriesByType("mark").map((mark) => [mark.name, mark.startTime]));
  const first = new Map(marks).get("tilescope: first frame");
  assert.ok(first > 0, `no mark of the first frame among ${JSON.stringify(marks)}`);
  t.diagnostic(`first interactive frame ${Math.round(first)} ms after navigation`);
  await state(page, (told) => told.gpu !== "testing");
  await page.mouse.move(5, 795);
  /** Returns how much is drawn in two seconds of the page's clock. */
  const drawn = () =>
    page.evaluate(async () => {
      const [before, start_ms] = [window.drawn, performance.now()];
      while (performance.now() < start_ms + 2_000) {
        await new Promise((resolve) => requestAnimationFrame(resolve));
      }
      return window.drawn - before;
    });
  // Once all is computed, nothing is drawn.
  await until("two seconds without a picture", async () => (await drawn()) === 0);
  assert.equal(await drawn(), 0, "it draws while nothing happens");
  // Negative control: drawing is counted.
  const [count] = await Promise.all([drawn(), ask(page, { do: "seek", part: 0.5 })]);
  assert.ok(count > 0);
});

test("a browser without WebAssembly is told so, with a picture", async (t) => {
  const { page } = await opened(t, "?play", {
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
  const { page } = await opened(t, "?play", { prepare: (context) => context.addInitScript(takeDisplays) });
  await page.waitForSelector("#missing:not([hidden])");
  assert.match(await page.textContent("#missing-list"), /neither WebGL 2 nor WebGPU/);
  await pictured(page, "#missing img");
});

test("without scripts the page says that it needs them", async (t) => {
  const { page } = await opened(t, "?play", { settings: { javaScriptEnabled: false } });
  await page.waitForSelector("noscript p", { state: "visible" });
  assert.match(await page.textContent("noscript p"), /allow JavaScript/);
  await pictured(page, ".hero img");
});

test("a module that cannot be loaded is reported", async (t) => {
  const { page } = await opened(t, "?play", {
    prepare: (context) => context.route(/sheets-/, (route) => route.abort()),
    expected: [/Failed to load resource/],
  });
  await page.waitForSelector("#failure:not([hidden])");
  assert.match(await page.textContent("#failure-text"), /cannot be loaded/);
  assert.equal(await page.isHidden("#loading"), true);
  await shows(page, await page.locator("#failure .card").boundingBox());
});

test("a worker that cannot be loaded is reported", async (t) => {
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
  const { page } = await reused(t);
  const kept = (key, ctrlKey = false) =>
    page.evaluate(
      ([key, ctrlKey]) => {
        const event = new KeyboardEvent("keydown", { key, ctrlKey, bubbles: true, cancelable: true });
        return !document.getElementById("canvas").dispatchEvent(event);
      },
      [key, ctrlKey],
    );
  for (const [key, ctrl] of [["F8"], ["F10"], ["k", true], ["e", true], ["s", true]]) {
    assert.equal(await kept(key, ctrl), true, key);
  }
  for (const [key, ctrl] of [["F5"], ["F11"], ["F12"], ["r", true], ["c", true], ["t", true], ["F6"]]) {
    assert.equal(await kept(key, ctrl), false, key);
  }
});

/** Serves the files of another server, but of the program only the share released so far. */
async function doled(t, server) {
  const gate = { share: 0, more: () => {} };
  const allow = (share) => {
    gate.share = share;
    gate.more();
  };
  const own = createServer(async ({ url }, response) => {
    const answer = await fetch(server.address + url);
    response.setHeader("Content-Type", answer.headers.get("Content-Type"));
    const bytes = Buffer.from(await answer.arrayBuffer());
    for (let sent = 0; url.endsWith(".wasm") && sent < bytes.length; ) {
      const end = Math.ceil(gate.share * bytes.length);
      response.write(bytes.subarray(sent, end));
      sent = end;
      await new Promise((resolve) => (gate.more = resolve));
    }
    response.end(url.endsWith(".wasm") ? "" : bytes);
  });
  own.listen(0, "127.0.0.1");
  await once(own, "listening");
  t.after(() => own.closeAllConnections());
  t.after(() => own.close());
  return { address: `http://127.0.0.1:${own.address().port}`, allow };
}

slowTest("where the browser does not report the size of the canvas, the program draws all the same", async (t) => {
  const { page } = await started(t, "?engine=cpu", {
    prepare: (context) =>
      context.addInitScript(() => {
        let observers = 0;
        const Whole = window.ResizeObserver;
        window.ResizeObserver = class extends Whole {
          constructor(report) {
            // The first observer is the page's own, and the second that of the program.
            let isLost = (observers += 1) === 2;
            super((...given) => {
              if (!isLost) {
                report(...given);
              }
              isLost = false;
            });
          }
        };
      }),
  });
  assert.equal(await page.evaluate(() => document.getElementById("canvas").style.maxWidth), "");
});

test("loading shows its progress", async (t) => {
  const server = await doled(t, await host());
  const { page } = await opened(t, "?play", { server });
  const bar = page.locator("#loading-bar");
  const lights = [];
  for (const share of [0.25, 0.5, 0.75]) {
    server.allow(share);
    await page.waitForFunction((share) => Number(document.getElementById("loading-bar").getAttribute("value")) >= share, share);
    const percent = Math.floor(100 * share);
    assert.equal(await page.textContent("#loading-size"), `${percent}%`);
    lights.push((await pixels(page, await bar.boundingBox())).mean);
  }
  // A filled bar is lighter than an empty one on a dark page, and darker on a light page.
  const steps = [lights[1] - lights[0], lights[2] - lights[1]];
  assert.ok(steps[0] * steps[1] > 0, `the bar does not fill: ${lights}`);
});

test("the page can be installed: its manifest is sound, and its icons are of the sizes that it tells", async (t) => {
  const { context, page } = await reused(t);
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
  assert.deepEqual([manifest.name, manifest.display, manifest.start_url], ["Tilescope", "standalone", "./?play"]);
  assert.deepEqual(icons.map(({ is }) => is), icons.map(({ told }) => told));
  for (const purpose of ["any", "maskable"]) {
    const sizes = icons.filter((icon) => icon.purpose === purpose).map(({ is }) => is);
    assert.deepEqual(sizes, ["192x192", "512x512"], purpose);
  }
});

/** Records each picture that the program draws on a page. */
function film() {
  window.film = new Set();
  window.filmed = () => {
    const small = new OffscreenCanvas(100, 90).getContext("2d");
    const canvas = document.getElementById("canvas");
    const place = [420, 200, 400, 350].map((length) => (length * canvas.width) / canvas.clientWidth);
    small.drawImage(canvas, ...place, 0, 0, 100, 90);
    const { data } = small.getImageData(0, 0, 100, 90);
    // If nothing was drawn, the canvas is empty.
    if (data.some((value) => value > 0)) {
      window.film.add(data.join());
    }
  };
}

/** Opens the page with a slow clock, and films it. */
async function filmed(t, reducedMotion) {
  const { page } = await started(t, "?engine=cpu&display=webgl#v=1&radius=0.02", {
    settings: { reducedMotion },
    prepare: async (context) => {
      await context.addInitScript(slowClock);
      await context.addInitScript(film);
    },
  });
  await page.mouse.move(5, 795);
  return page;
}

/** Makes the camera show the whole domain, and returns how many pictures that takes. */
async function flown(page) {
  await load(page, "v=1&radius=0.02&camera=20,20,40");
  await shows(page);
  await page.evaluate(() => window.film.clear());
  await page.keyboard.press("f");
  await state(page, (told) => !told.link.includes("camera"));
  // Longer than a flight, by the page's clock.
  const start_ms = await page.evaluate(() => performance.now());
  await page.waitForFunction((start_ms) => performance.now() > start_ms + 2_000, start_ms, { timeout: PATIENCE_MS });
  await shows(page);
  return page.evaluate(() => window.film.size);
}

slowTest("the camera flies where motion is welcome, and jumps from the moment when the system wishes for less", async (t) => {
  const page = await filmed(t, "no-preference");
  const flight = await flown(page);
  assert.ok(flight > 6, `${flight} pictures`);
  await page.emulateMedia({ reducedMotion: "reduce" });
  await page.waitForFunction(() => matchMedia("(prefers-reduced-motion: reduce)").matches);
  const jump = await flown(page);
  assert.ok(jump <= 2, `${jump} pictures`);
});

test("the camera jumps where motion is to be reduced from the start", async (t) => {
  const page = await filmed(t, "reduce");
  const jump = await flown(page);
  assert.ok(jump <= 2, `${jump} pictures`);
});

test("the focus of the keyboard is visible", async (t) => {
  const { page } = await reused(t);
  for (let k = 0; k < 3; k += 1) {
    const before = await rests(page);
    await page.keyboard.press("Tab");
    await changed(page, before, WHOLE);
  }
});
