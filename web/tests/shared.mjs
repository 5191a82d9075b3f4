// The server, the browser and the pages that tests share, and the contexts in which a test opens pages of its own.

import assert from "node:assert/strict";
import { after } from "node:test";
import { PATIENCE_MS, launch, load, nothingElse, ready, serve, state, watch } from "./harness.mjs";

/** Begun by the first test. */
const shared = {};
/** The pages that tests share, by how they were opened. */
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
 * How a test opens its pages.
 * @typedef {object} Wishes
 * @property {{address: string}} [server] another one than the one that is shared
 * @property {object} [settings] of the context
 * @property {(context: import("playwright-core").BrowserContext) => Promise<void>} [prepare] is called before a page is opened
 * @property {RegExp[]} [expected] what goes wrong on purpose; all else fails the test
 * @property {string[]} [origins] of other servers that may be asked for something
 * @property {{x: number, y: number, width: number, height: number}} [clip] where the run is seen
 */

/** The layout of a desktop at half its pixels, each of which a renderer without a GPU has to draw. */
const DESKTOP = { viewport: { width: 1280, height: 800 }, deviceScaleFactor: 0.5 };

/** Makes a context, and returns what goes wrong on its pages. @param {Wishes} wishes */
export async function makeContext({ server, settings = {}, prepare, origins = [] } = {}) {
  server ??= await host();
  shared.browser ??= launch();
  const browser = await shared.browser;
  const context = await browser.newContext({ ...DESKTOP, ...settings });
  context.setDefaultTimeout(PATIENCE_MS);
  const wrong = watch(context, [server.address, ...origins]);
  await prepare?.(context);
  return { server, context, wrong };
}

/**
 * Returns a context of its own, which ends with the test.
 * @param {import("node:test").TestContext} t
 * @param {Wishes} wishes
 */
export async function contextOf(t, wishes = {}) {
  const { server, context, wrong } = await makeContext(wishes);
  t.after(async () => {
    // What goes wrong when it ends is nobody's.
    const all = [...wrong];
    await context.close();
    nothingElse(all, wishes.expected ?? []);
  });
  return { server, context };
}

/**
 * Opens the page in a context of its own.
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

/** As `opened`, once the session is there, verified and seen. @param {Parameters<typeof opened>} given */
export async function started(...given) {
  const made = await opened(...given);
  await ready(made.page, given[2]?.clip);
  return made;
}

/** What a shared page shows when a test begins. */
const LINK = "v=1&radius=0.02";

/** Opens a page for many tests, and keeps what its program says of itself at first. @param {string} query @param {Wishes} wishes */
async function openShared(query, wishes) {
  const made = await makeContext(wishes);
  const page = await made.context.newPage();
  await page.goto(`${made.server.address}/${query}#${LINK}`);
  await ready(page, wishes.clip);
  await state(page, (told) => told.gpu !== "testing");
  // Made anew, by whoever makes all that follow: while a GPU is tested the CPU samples.
  await load(page, "v=1&radius=0.03");
  return { ...made, page, fresh: await load(page, LINK) };
}

/**
 * Returns the page that tests share which ask for the same address and the same settings. Whatever the tests before
 * have done, it is in the state in which it was opened, to the last field of what the program says of itself. A test that
 * fails takes its page with it.
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
    if (!t.passed) {
      pages.delete(key);
      await made.context.close();
    }
    nothingElse(made.wrong.splice(0), []);
  });
  await backTo(made.page, made.fresh);
  return made;
}

/** Brings a page to a state in which it was before. */
async function backTo(page, fresh) {
  await page.mouse.move(5, 795);
  await page.focus("#canvas");
  assert.deepEqual(await load(page, fresh.link), fresh);
}
