// The part of the program that the start does without: it arrives after the first frame, at once where it is needed
// before, and where it cannot be had the page says so and nothing is lost.

import assert from "node:assert/strict";
import { test } from "node:test";
import { PATIENCE_MS, ask, shows, state, typing, until } from "./harness.mjs";
import { contextOf } from "./shared.mjs";

const LATER = /\/tilescope_later-[0-9a-f]{12}\.wasm$/;

/** The start of all parts of the program, of a small run. */
const LINK = "?engine=cpu#v=1&radius=0.03&seed=5";

/** Opens the page, and does something else with each request for the later part. */
async function openedWith(t, handle, expected = []) {
  const { server, context } = await contextOf(t, { expected });
  await context.route(LATER, handle);
  const page = await context.newPage();
  await page.goto(`${server.address}/${LINK}`);
  return { context, page };
}

/** Waits for the first frame and the run. */
async function begun(page) {
  await state(page, (told) => told.ready);
  await shows(page);
}

/** Whether the later part has come to the page itself. */
const isThere = (page) => page.evaluate(() => performance.getEntriesByName("tilescope: all is there").length > 0);

/** Exports the set, and returns what is downloaded. */
async function exported(page) {
  const coming = page.waitForEvent("download", { timeout: PATIENCE_MS });
  await page.keyboard.press("Control+e");
  await typing(page);
  await page.keyboard.press("Enter");
  return coming;
}

test("the later part is asked for once the first frame is there", async (t) => {
  const { page } = await openedWith(t, (route) => route.continue());
  await begun(page);
  await until("the later part", () => isThere(page));
  const [drawn_ms, asked_ms] = await page.evaluate(() => [
    performance.getEntriesByName("tilescope: first frame")[0].startTime,
    performance.getEntriesByType("resource").find(({ name }) => name.includes("/tilescope_later-")).startTime,
  ]);
  assert.ok(asked_ms >= drawn_ms, `${asked_ms} ms, before the first frame at ${drawn_ms} ms`);
  assert.equal((await state(page, (told) => told.verified !== null)).verified, true);
});

test("the later part comes at once where it is needed before", async (t) => {
  let held = 0;
  const hold = async (route) => {
    const isWaitedFor = route.request().resourceType() === "xhr";
    // What the page fetches beside its work never arrives.
    held += isWaitedFor ? 0 : 1;
    await (isWaitedFor ? route.continue() : undefined);
  };
  const { page } = await openedWith(t, hold);
  await begun(page);
  await until("a request that is held back", async () => held > 0);
  assert.equal(await isThere(page), false);
  const download = await exported(page);
  assert.match(download.suggestedFilename(), /\.zip$/);
  assert.equal(await isThere(page), true);
});

test("without its later part the page asks, says what is missing, and loses nothing", async (t) => {
  const refused = [/net::ERR_FAILED/, /did not come yet/, /could not be loaded/];
  const { context, page } = await openedWith(t, (route) => route.abort(), refused);
  await begun(page);
  await page.evaluate(() => localStorage.setItem("lessons", '{"kept":"as it was"}'));
  await ask(page, { do: "seek", event: 100 });
  await until("the moment in the address", async () => page.url().includes("at=100"));

  // OK tries again, as often as one likes; Cancel ends the program.
  const questions = [];
  page.on("dialog", async (dialog) => {
    questions.push(dialog.message());
    await (questions.length < 3 ? dialog.accept() : dialog.dismiss());
  });
  await page.click("#canvas", { position: { x: 620, y: 400 } });
  await page.keyboard.press("Control+e");
  await page.waitForSelector("#failure:not([hidden])");
  assert.equal(questions.length, 3);
  assert.match(questions[0], /rest of the program.*could not be loaded.*network/);
  assert.match(await page.textContent("#failure-text"), /rest of the program.*results are kept/);
  assert.equal(await page.evaluate(() => localStorage.getItem("lessons")), '{"kept":"as it was"}');

  // With a network again, the same address leads back to the same moment.
  await context.unroute(LATER);
  await page.click("#failure-reload");
  assert.equal((await state(page, (told) => told.ready && told.verified !== null)).cursor, 100);
});
