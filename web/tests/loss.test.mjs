// A lost device is replaced by another display, with a notice, and the state is kept.

import assert from "node:assert/strict";
import { test } from "node:test";
import { shows, slowTest, state } from "./harness.mjs";
import { started } from "./shared.mjs";

/** Records the WebGPU devices of a page, so that a test can destroy them. */
function rememberDevices() {
  window.devices = [];
  const original = GPUAdapter.prototype.requestDevice;
  GPUAdapter.prototype.requestDevice = async function (...options) {
    const device = await original.apply(this, options);
    window.devices.push(device);
    return device;
  };
}

test("a lost display is replaced by WebGL 2, with the same session", async (t) => {
  const { page } = await started(t, "?display=webgpu&engine=cpu#v=1&seed=8&radius=0.02&at=999", {
    prepare: (context) => context.addInitScript(rememberDevices),
  });
  const before = await state(page, (told) => told.cursor === 999);
  assert.equal(await page.evaluate(() => window.tilescope.display()), "WebGPU");
  await page.waitForFunction((link) => location.hash === `#${link}`, before.link);
  assert.ok((await page.evaluate(() => window.devices.length)) > 0, "no device was asked for");
  await page.evaluate(() => window.devices.forEach((device) => device.destroy()));
  await page.waitForFunction(() => window.tilescope.display() === "WebGL 2");
  const after = await state(page, (told) => told.ready && told.cursor === 999 && told.verified !== null);
  assert.equal(after.positions_digest, before.positions_digest);
  assert.match(after.notice, /lost/);
  await shows(page);
});

/** Slows a page's clock down, so that delays of a busy machine seem short. */
function slowClock() {
  const now = performance.now.bind(performance);
  performance.now = () => now() / 4;
}

slowTest("a lost WebGL context is replaced, and a second loss at once is reported", async (t) => {
  const { page } = await started(t, "?display=webgl&engine=cpu#v=1&seed=8&radius=0.02&at=999", {
    prepare: (context) => context.addInitScript(slowClock),
  });
  const before = await state(page, (told) => told.cursor === 999);
  await page.waitForFunction((link) => location.hash === `#${link}`, before.link);
  const lose = () =>
    page.evaluate(() => {
      const context = document.getElementById("canvas").getContext("webgl2");
      context.getExtension("WEBGL_lose_context").loseContext();
    });
  await lose();
  const after = await state(page, (told) => told.ready && told.cursor === 999 && told.verified !== null && told.notice !== null);
  assert.equal(after.positions_digest, before.positions_digest);
  assert.match(after.notice, /lost/);
  await shows(page);
  await lose();
  await page.waitForSelector("#failure:not([hidden])");
  assert.match(await page.textContent("#failure-text"), /lost/);
});
