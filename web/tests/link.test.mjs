// Permalinks: the address follows what is done and leads back to it; hostile ones lead to the nearest valid state.

import assert from "node:assert/strict";
import { test } from "node:test";
import { ask, open, shows, state } from "./harness.mjs";
import { started as startedAt } from "./shared.mjs";

const started = (t, fragment = "") => startedAt(t, `?engine=cpu${fragment}`);

test("what is shown is in the address, without a step of history, and comes back from it", async (t) => {
  const { server, context, page, wrong } = await started(t);
  const before = await page.evaluate(() => history.length);
  await ask(page, { do: "load", parameters: { seed: 77, radius: 0.02 } });
  await state(page, (told) => told.ready && told.seed === 77 && told.verified !== null);
  await ask(page, { do: "seek", event: 1234 });
  const shown = await state(page, (told) => told.cursor === 1234);
  await page.waitForFunction((link) => location.hash === `#${link}`, shown.link);
  assert.match(shown.link, /seed=77/);
  assert.match(shown.link, /at=1234/);
  assert.equal(await page.evaluate(() => history.length), before);
  const address = await page.evaluate(() => location.href);
  assert.ok(address.startsWith(server.address));
  const again = await open(context, address);
  const back = await state(again.page, (told) => told.ready && told.verified !== null && told.cursor === 1234);
  assert.equal(back.link, shown.link);
  assert.equal(back.positions_digest, shown.positions_digest);
  // A link that is followed on the same page.
  await page.evaluate(() => {
    location.hash = "v=1&seed=5&radius=0.02";
  });
  const other = await state(page, (told) => told.ready && told.seed === 5 && told.verified !== null);
  assert.notEqual(other.positions_digest, shown.positions_digest);
  assert.deepEqual([...wrong, ...again.wrong], []);
});

/** Links that do harm or make no sense, and what is said of each. */
const HOSTILE = {
  "numbers that are none": ["v=1&radius=NaN&leaf=-inf&seed=abc&camera=NaN,1e999,0", /radius.*NaN/],
  "a billion samples": ["v=1&radius=0.00000001&width=100000&height=100000", /radius|samples/],
  "a pattern of a million r": ["v=1&pattern=1000000", /pattern.*1,?000,?000/i],
  "a newer version with keys of its own": ["v=999&seed=4&hologram=yes", /hologram.*version 999.*knows version 1/],
  "a million bookmarks": [`v=1&bookmarks=${"1:a;".repeat(12_000)}`, /bookmarks/],
  "escapes and layouts that are none": ["v=1&layout=!!!!&watch=%zz%&select=sample:99999999999", /layout/],
  "nothing but noise": ["\u{1F9E8}=%00&&&===&v=v=v", /version/],
};

for (const [name, [fragment, said]] of Object.entries(HOSTILE)) {
  test(`a link with ${name} opens the nearest valid state and says what was dropped`, async (t) => {
    const { page, wrong } = await started(t, `#${fragment}`);
    const told = await state(page);
    assert.equal(told.verified, true);
    assert.ok(told.samples > 0 && told.samples <= 210_000, `${told.samples} samples`);
    assert.match(told.notice, said);
    await shows(page);
    assert.deepEqual(wrong, []);
  });
}

test("a good link drops nothing", async (t) => {
  const { page, wrong } = await started(t, "#v=1&seed=9&radius=0.02");
  const told = await state(page, (told) => told.seed === 9);
  assert.equal(told.notice, null);
  assert.deepEqual(wrong, []);
});

test("a link is copied to the clipboard", async (t) => {
  const { context, page, wrong } = await started(t, "#v=1&seed=9&radius=0.02");
  await context.grantPermissions(["clipboard-read", "clipboard-write"]);
  await page.click("#canvas", { position: { x: 640, y: 400 } });
  // Whoever types does not wait for slow frames.
  await page.keyboard.press("Control+k");
  await page.keyboard.type("copy link");
  await page.keyboard.press("Enter");
  await page.waitForFunction(async () => (await navigator.clipboard.readText()).includes("#v=1&seed=9"));
  assert.deepEqual(wrong, []);
});
