// After the first visit the page needs no network; a new version is offered, not forced.

import assert from "node:assert/strict";
import { cp, readFile, rm, writeFile } from "node:fs/promises";
import path from "node:path";
import { test } from "node:test";
import { DIST, folder, launch, open, ready, serve, state } from "./harness.mjs";

async function controlled(page) {
  await page.evaluate(async () => {
    const registration = await navigator.serviceWorker.ready;
    if (registration.active.state !== "activated") {
      await new Promise((resolve) => registration.active.addEventListener("statechange", resolve));
    }
  });
}

test("the page works without a network after the first visit", async (t) => {
  const server = await serve();
  const browser = await launch();
  t.after(() => browser.close());
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 } });
  const { page } = await open(context, `${server.address}/#v=1&seed=6&radius=0.02`);
  await ready(page);
  await controlled(page);
  await server.stop();
  const again = await open(context, `${server.address}/#v=1&seed=6&radius=0.02`);
  await ready(again.page);
  const told = await state(again.page);
  assert.equal(told.verified, true);
  assert.equal(told.seed, 6);
  assert.deepEqual(again.wrong, []);
});

test("a new version is offered, and comes with the user's consent", async (t) => {
  const copy = await folder(t);
  await cp(DIST, copy, { recursive: true });
  const server = await serve(copy);
  t.after(server.stop);
  const browser = await launch();
  t.after(() => browser.close());
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 } });
  const first = await open(context, `${server.address}/#v=1&seed=6&radius=0.02`);
  await ready(first.page);
  await controlled(first.page);
  assert.equal(await first.page.isHidden("#notice"), true);
  // Another version: its worker differs.
  const worker = path.join(copy, "sw.js");
  await writeFile(worker, `${await readFile(worker, "utf8")}\n// another version\n`);
  await Promise.all([".br", ".gz"].map((ending) => rm(worker + ending)));
  await first.page.reload();
  await first.page.waitForSelector("#notice:not([hidden])");
  assert.match(await first.page.textContent("#notice"), /new version/i);
  await Promise.all([first.page.waitForEvent("load"), first.page.click("#notice-reload")]);
  await ready(first.page);
  const told = await state(first.page);
  assert.equal(told.seed, 6, "the address was kept");
  assert.deepEqual(first.wrong, []);
});
