// The server, the browser and the pages that tests share, and contexts for a test's own pages.

import assert from "node:assert/strict";
import { after } from "node:test";
import { PATIENCE_MS, launch, load, nothingElse, ready, serve, state, tellIfFailed, watch } from "./harness.mjs";

/** Started by the first test. */
const shared = {};
/** The pages that tests share, by address and settings. */
const pages = new Map();
after(async () => {
  await (await shared.browser)?.close();
  await (await shared.server)?.stop();
});

/** Returns the server that the tests of a file share. */
export function host() {
  return (shared.server ??= serve());
}

/**
 * Options with which a test opens its pages.
 * @typedef {object} Wishes
 * @property {{address: string}} [server] used instead of the shared one
 * @property {object} [settings] of the context
 * @property {boolean} [first] whether the visit is the first one, which begins with the tour
 * @property {(context: import("playwright-core").BrowserContext) => Promise<void>} [prepare] is called before a page is opened
 * @property {RegExp[]} [expected] expected errors; any other error fails the test
 * @property {string[]} [origins] of other servers to which requests are allowed
 * @property {{x: number, y: number, width: number, height: number}} [clip] the part of the page that shows the run
 */

/** The layout of a desktop at half its resolution, to save time for software renderers. */
const DESKTOP = { viewport: { width: 1280, height: 800 }, deviceScaleFactor: 0.5 };

/** Stores the look, as an earlier visit has done. */
export function visitedBefore() {
  try {
    localStorage.setItem("look", '["dark",null]');
  } catch {
    // The initial empty page has no storage.
  }
}

/** Makes a context, and returns it with the list of errors on its pages. @param {Wishes} wishes */
export async function makeContext({ server, settings = {}, first = false, prepare, origins = [] } = {}) {
  server ??= await host();
  shared.browser ??= launch();
  const browser = await shared.browser;
  const context = await browser.newContext({ ...DESKTOP, ...settings });
  context.setDefaultTimeout(PATIENCE_MS);
  const wrong = watch(context, [server.address, ...origins]);
  if (!first) {
    await context.addInitScript(visitedBefore);
  }
  await prepare?.(context);
  return { server, context, wrong };
}

/**
 * Returns a new context, which ends with the test.
 * @param {import("node:test").TestContext} t
 * @param {Wishes} wishes
 */
export async function contextOf(t, wishes = {}) {
  const { server, context, wrong } = await makeContext(wishes);
  t.after(async () => {
    // Errors while it ends are ignored.
    const all = [...wrong];
    tellIfFailed(t, all);
    await context.close();
    nothingElse(all, wishes.expected ?? []);
  });
  return { server, context };
}

/**
 * Opens the page in a new context.
 * @param {import("node:test").TestContext} t
 * @param {string} query the end of its address: query and fragment
 * @param {Wishes} wishes
 */
export async function opened(t, query = "", wishes = {}) {
  const { server, context } = await contextOf(t, wishes);
  const page = await context.newPage();
  await page.goto(`${server.address}/${query}`);
  return { server, context, page };
}

/** As `opened`, once the session is there, verified and drawn. @param {Parameters<typeof opened>} given */
export async function started(...given) {
  const made = await opened(...given);
  await ready(made.page, given[2]?.clip);
  return made;
}

/** The link of a shared page when a test begins. */
const LINK = "v=1&radius=0.02";

/** Opens a page for many tests, and stores the initial state of its program. @param {string} query @param {Wishes} wishes */
async function openShared(query, wishes) {
  const made = await makeContext(wishes);
  const page = await made.context.newPage();
  await page.goto(`${made.server.address}/${query}#${LINK}`);
  await ready(page, wishes.clip);
  await state(page, (told) => told.gpu !== "testing");
  // Sample again with the final engine: while a GPU is tested the CPU samples.
  if (!query.includes("engine=cpu")) {
    await load(page, "v=1&radius=0.03");
  }
  return { ...made, page, fresh: await load(page, LINK) };
}

/**
 * Returns the page that tests with the same address and settings share. Whatever earlier tests did, it is in the state
 * in which it was opened, in every field of the program's state. After a failed test its page is not used again.
 * @param {import("node:test").TestContext} t
 * @param {string} query the query of its address
 * @param {Wishes} wishes
 */
export async function reused(t, query = "?engine=cpu", wishes = {}) {
  const key = JSON.stringify([query, wishes.settings]);
  if (!pages.has(key)) {
    pages.set(key, openShared(query, wishes));
  }
  const made = await pages.get(key);
  t.after(async () => {
    tellIfFailed(t, made.wrong);
    if (!t.passed) {
      pages.delete(key);
      await made.context.close();
    }
    nothingElse(made.wrong.splice(0), []);
  });
  await backTo(made.page, made.fresh);
  return made;
}

/** Restores an earlier state of a page. */
async function backTo(page, fresh) {
  await page.mouse.move(5, 795);
  await page.focus("#canvas");
  assert.deepEqual(await load(page, fresh.link), fresh);
}
