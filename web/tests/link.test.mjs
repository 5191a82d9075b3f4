// Permalinks: the address follows the state and restores it; hostile links give the nearest valid state.

import assert from "node:assert/strict";
import { test } from "node:test";
import { PATIENCE_MS, ask, load, ready, shows, slowTest, state } from "./harness.mjs";
import { reused, started } from "./shared.mjs";

/** Follows a link on a page. */
const follow = (page, link) => page.evaluate((link) => (location.hash = link), link);

test("the address follows the view without steps of history, and restores it", async (t) => {
  const { server, context, page } = await reused(t);
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
  const again = await context.newPage();
  await again.goto(address);
  await ready(again);
  const back = await state(again, (told) => told.cursor === 1234);
  assert.equal(back.link, shown.link);
  assert.equal(back.positions_digest, shown.positions_digest);
  await again.close();
  // A link that is followed on the same page.
  await follow(page, "v=1&seed=5&radius=0.02");
  const other = await state(page, (told) => told.ready && told.seed === 5 && told.verified !== null);
  assert.notEqual(other.positions_digest, shown.positions_digest);
  await shows(page);
});

/** Follows a link while the program requests its display, and continues once the page has handled it. */
function followMeanwhile(link) {
  const original = GPUAdapter.prototype.requestDevice;
  GPUAdapter.prototype.requestDevice = async function (...options) {
    const heard = new Promise((resolve) => addEventListener("hashchange", resolve, { once: true }));
    location.hash = link;
    await heard;
    return original.apply(this, options);
  };
}

test("a link that is followed while the program starts is opened", async (t) => {
  const { page } = await started(t, "?engine=cpu&display=webgpu#v=1&seed=9&radius=0.02", {
    prepare: (context) => context.addInitScript(followMeanwhile, "v=1&seed=5&radius=0.02"),
  });
  const told = await state(page, (told) => told.ready && told.seed === 5 && told.verified !== null);
  await page.waitForFunction((link) => location.hash === `#${link}`, told.link);
  await shows(page);
});

test("a link is opened that is followed just before the program writes its own", async (t) => {
  const { page } = await reused(t);
  await page.evaluate(() => {
    const own = location.href;
    location.hash = "v=1&seed=6&radius=0.02";
    history.replaceState(history.state, "", own);
  });
  await state(page, (told) => told.ready && told.seed === 6 && told.verified !== null);
});

slowTest("a link that is followed while a lost display is replaced is opened", async (t) => {
  const { page } = await started(t, "?engine=cpu&display=webgl#v=1&seed=9&radius=0.02");
  await page.evaluate(() => {
    const canvas = document.getElementById("canvas");
    // After the page has ended the program, which starts again.
    canvas.addEventListener("webglcontextlost", () => (location.hash = "v=1&seed=5&radius=0.02"));
    canvas.getContext("webgl2").getExtension("WEBGL_lose_context").loseContext();
  });
  const told = await state(page, (told) => told.ready && told.seed === 5 && told.verified !== null);
  await page.waitForFunction((link) => location.hash === `#${link}`, told.link);
  await shows(page);
});

/** Harmful or nonsensical links, and the notice for each. */
const HOSTILE = {
  "numbers that are none": ["v=1&radius=NaN&leaf=-inf&seed=abc&camera=NaN,1e999,0", /radius.*NaN/],
  "a billion samples": ["v=1&radius=0.00000001&width=100000&height=100000", /radius|samples/],
  "a pattern of a million r": ["v=1&pattern=1000000", /pattern.*1,?000,?000/i],
  "a newer version with keys of its own": ["v=999&seed=4&hologram=yes", /hologram.*version 999.*knows version 2/],
  "thousands of bookmarks": [`v=1&mark=${"1:a;".repeat(12_000)}`, /12,001 of the kind "mark"; the first 64 were read/],
  "more bytes than are read": [
    `v=1&radius=0.02&mark=${"1:a;".repeat(20_000)}`,
    /link has 80,021 bytes; everything after the first 65,536 was left out/,
  ],
  "escapes and layouts that are none": ["v=1&layout=!!!!&watch=%zz%&select=sample:99999999999", /layout/],
  "nothing but noise": ["\u{1F9E8}=%00&&&===&v=v=v", /version/],
};

// How a link is read is tested natively, so that a page shows the first two by default: one as it starts, one that it follows.
for (const [k, [name, [fragment, said]]] of Object.entries(HOSTILE).entries()) {
  const declare = k < 2 ? test : slowTest;
  declare(`a link with ${name} opens the nearest valid state and says what was dropped`, async (t) => {
    // The first is opened in a new page, the others are followed on an open page.
    const { page } = k === 0 ? await started(t, `?engine=cpu#${fragment}`) : await reused(t);
    if (k > 0) {
      await follow(page, fragment);
    }
    const told = await state(page, (told) => told.ready && told.verified !== null && told.notice !== null);
    assert.equal(told.verified, true);
    assert.ok(told.samples > 0 && told.samples <= 210_000, `${told.samples} samples`);
    assert.match(told.notice, said);
    await shows(page);
  });
}

test("a good link drops nothing", async (t) => {
  const { page } = await reused(t);
  await follow(page, "v=1&seed=9&radius=0.02");
  const told = await state(page, (told) => told.ready && told.verified !== null && told.seed === 9);
  assert.equal(told.notice, null);
});

/** Takes the clipboard from a page, as if it were not served by https. Texts copied with the old interface are recorded, if that is allowed. */
function oldClipboard(allowed) {
  window.copied = null;
  Object.defineProperty(navigator, "clipboard", { value: undefined, configurable: true });
  document.execCommand = (what) => {
    window.copied = [what, document.activeElement.value];
    return allowed;
  };
}

/** Gives the clipboard back to a page. */
function newClipboard() {
  delete navigator.clipboard;
  delete document.execCommand;
}

/** Makes a page copy its link without a clipboard, and returns the copied texts. */
async function copied(page, allowed) {
  await page.evaluate(oldClipboard, allowed);
  await page.click("#canvas", { position: { x: 640, y: 300 } });
  await page.keyboard.press("Control+Shift+l");
  await page.waitForFunction(() => window.copied, null, { timeout: PATIENCE_MS });
  const made = await page.evaluate(() => window.copied);
  await page.evaluate(newClipboard);
  return made;
}

for (const [query, kept] of [
  ["?engine=cpu", "?engine=cpu"],
  ["?embed=player&engine=cpu&origin=https://lecture.example", "?engine=cpu"],
]) {
  test(`a link is copied without a clipboard, from ${query}`, async (t) => {
    const { page } = await reused(t, query);
    await load(page, "v=1&seed=9&radius=0.02");
    const [what, text] = await copied(page, true);
    const { origin, pathname } = new URL(page.url());
    assert.equal(what, "copy");
    assert.ok(text.startsWith(`${origin}${pathname}${kept}#v=1&seed=9&radius=0.02`), text);
    await state(page, (told) => told.notice?.startsWith("The link is copied"));
    assert.equal(await page.evaluate(() => document.activeElement.id), "canvas");
  });
}

test("a link that the browser does not copy gives a notice", async (t) => {
  const { page } = await reused(t);
  await copied(page, false);
  const { notice } = await state(page, (told) => told.notice?.includes("did not let"));
  assert.match(notice, /address bar/);
});

test("a link is copied to the clipboard", async (t) => {
  const { context, page } = await reused(t);
  await context.grantPermissions(["clipboard-read", "clipboard-write"]);
  await load(page, "v=1&seed=9&radius=0.02");
  await page.click("#canvas", { position: { x: 640, y: 400 } });
  // Users type without waiting for slow frames.
  await page.keyboard.press("Control+k");
  await page.keyboard.type("copy link");
  await page.keyboard.press("Enter");
  await page.waitForFunction(async () => (await navigator.clipboard.readText()).includes("#v=1&seed=9"));
});
