// The page begins: it shows the default session, verified, by either display, and says what it lacks where it cannot.

import assert from "node:assert/strict";
import { test } from "node:test";
import { ask, shows, state } from "./harness.mjs";
import { opened, started } from "./shared.mjs";

for (const [display, name] of [["webgpu", "WebGPU"], ["webgl", "WebGL 2"]]) {
  test(`the default session is shown and verified by ${name}`, async (t) => {
    const { page, wrong } = await started(t, `?display=${display}`);
    const told = await state(page);
    assert.equal(told.verified, true);
    assert.equal(told.seed, 1);
    assert.ok(told.samples > 9_000 && told.samples < 11_000, `${told.samples} samples`);
    assert.ok(told.events > 40_000, `${told.events} events`);
    assert.equal(await page.evaluate(() => window.tilescope.display()), name);
    assert.match(told.chosen, new RegExp(name));
    await shows(page);
    assert.equal(await page.isHidden("#loading"), true);
    assert.deepEqual(wrong, []);
  });
}

test("the first frame comes soon after the load, and the page is idle when nothing happens", async (t) => {
  const { page, wrong } = await started(t);
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
  assert.deepEqual(wrong, []);
});

test("a browser without WebAssembly is told so, with a picture", async (t) => {
  const { page, wrong } = await opened(t, "", {}, (context) =>
    context.addInitScript(() => {
      delete globalThis.WebAssembly;
    }),
  );
  await page.waitForSelector("#missing:not([hidden])");
  assert.match(await page.textContent("#missing-list"), /WebAssembly/);
  await page.waitForFunction(() => document.querySelector("#missing img").naturalWidth > 0);
  assert.equal(await page.isVisible("#canvas"), false);
  assert.deepEqual(wrong, []);
});

test("a browser without WebGL 2 and WebGPU is told so, with a picture", async (t) => {
  const { page, wrong } = await opened(t, "", {}, (context) =>
    context.addInitScript(() => {
      HTMLCanvasElement.prototype.getContext = () => null;
      Object.defineProperty(Navigator.prototype, "gpu", { value: undefined });
    }),
  );
  await page.waitForSelector("#missing:not([hidden])");
  assert.match(await page.textContent("#missing-list"), /neither WebGL 2 nor WebGPU/);
  await page.waitForFunction(() => document.querySelector("#missing img").naturalWidth > 0);
  assert.deepEqual(wrong, []);
});

test("without scripts the page says that it needs them", async (t) => {
  const { page } = await opened(t, "", { javaScriptEnabled: false });
  await page.waitForSelector("noscript h2", { state: "visible" });
  assert.match(await page.textContent("noscript h2"), /needs JavaScript/);
});

test("a module that cannot be had is said", async (t) => {
  const { page } = await opened(t, "", {}, (context) => context.route(/sheets-/, (route) => route.abort()));
  await page.waitForSelector("#failure:not([hidden])");
  assert.match(await page.textContent("#failure-text"), /cannot be loaded/);
  assert.equal(await page.isHidden("#loading"), true);
});

test("a worker that cannot be had is said", async (t) => {
  const { page } = await opened(t, "?engine=cpu", {}, (context) => context.route(/worker-/, (route) => route.abort()));
  const told = await state(page, (told) => told.notice !== null);
  assert.match(told.notice, /script|worker/);
});

test("where WebGPU does not start WebGL 2 draws, and says why", async (t) => {
  const { page } = await started(t, "?engine=cpu#v=1&radius=0.02", {}, (context) =>
    context.addInitScript(() => {
      GPUAdapter.prototype.requestDevice = () => Promise.reject(new DOMException("no device", "OperationError"));
    }),
  );
  assert.equal(await page.evaluate(() => window.tilescope.display()), "WebGL 2");
  assert.match((await state(page)).notice, /WebGPU did not start/);
  await shows(page);
});

test("keys that mean something here are not the browser's, others are", async (t) => {
  const { page, wrong } = await started(t, "?engine=cpu#v=1&radius=0.02");
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
  assert.deepEqual(wrong, []);
});
