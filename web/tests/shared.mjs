// The server and the browser that the tests of one file share, and the contexts in which each test opens its pages.

import { after } from "node:test";
import { PATIENCE_MS, launch, nothingElse, ready, serve, watch } from "./harness.mjs";

/** Begun by the first test. */
const shared = {};
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

/**
 * Returns a context of its own, which ends with the test.
 * @param {import("node:test").TestContext} t
 * @param {Wishes} wishes
 */
export async function contextOf(t, { server, settings = {}, prepare, expected = [], origins = [] } = {}) {
  server ??= await host();
  shared.browser ??= launch();
  const browser = await shared.browser;
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, ...settings });
  context.setDefaultTimeout(PATIENCE_MS);
  const wrong = watch(context, [server.address, ...origins]);
  t.after(async () => {
    // What goes wrong when it ends is nobody's.
    const all = [...wrong];
    await context.close();
    nothingElse(all, expected);
  });
  await prepare?.(context);
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
