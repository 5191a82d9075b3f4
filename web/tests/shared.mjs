// The server and the browser that the tests of one file share.

import { after } from "node:test";
import { launch, open, ready, serve } from "./harness.mjs";

/** Begun by the first test. */
const shared = {};
after(async () => {
  await (await shared.browser)?.close();
  await (await shared.server)?.stop();
});

/** Returns the server and the browser that the tests of a file share. */
export async function host() {
  shared.server ??= serve();
  shared.browser ??= launch();
  return { server: await shared.server, browser: await shared.browser };
}

/**
 * Opens the page in a context of its own, which ends with the test.
 * @param {import("node:test").TestContext} t
 * @param {string} query the end of its address: query and fragment
 * @param {object} settings of the context
 * @param {(context: import("playwright-core").BrowserContext) => Promise<void>} prepare is called before the page is opened
 */
export async function opened(t, query = "", settings = {}, prepare = async () => {}) {
  const { server, browser } = await host();
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, ...settings });
  t.after(() => context.close());
  await prepare(context);
  const { page, wrong } = await open(context, `${server.address}/${query}`);
  return { server, context, page, wrong };
}

/** As `opened`, once the session is there and verified. @param {Parameters<typeof opened>} given */
export async function started(...given) {
  const made = await opened(...given);
  await ready(made.page);
  return made;
}
