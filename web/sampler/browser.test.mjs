// The package in a browser: a page imports its module from a server, and its set is the native program's. It needs what the tests of
// the page need, and runs in the browser that they use.

import assert from "node:assert/strict";
import { cp, writeFile } from "node:fs/promises";
import path from "node:path";
import { test } from "node:test";
import { folder, launch, nothingElse, serve, watch } from "../tests/harness.mjs";
import { PACKAGE, digest, native } from "./native.mjs";

const PAGE = '<!doctype html><html lang="en"><title>A sampler</title><link rel="icon" href="data:,">';

test("a page that imports the package gets the native program's set", async (t) => {
  const site = await folder(t);
  await cp(PACKAGE, path.join(site, "tilescope-sampler"), { recursive: true });
  await writeFile(path.join(site, "index.html"), PAGE);

  const server = await serve(site);
  t.after(() => server.stop());
  const browser = await launch();
  t.after(() => browser.close());
  const context = await browser.newContext();
  const wrong = watch(context, [server.address]);
  const page = await context.newPage();
  await page.goto(server.address);

  /** Returns the digest of the set of a seed, made in the page. @param {number} seed */
  const made = (seed) =>
    page.evaluate(async (seed) => {
      const { load } = await import("/tilescope-sampler/index.js");
      const { points } = (await load()).sample({ radius: 0.02, seed });
      const hash = new Uint8Array(await crypto.subtle.digest("SHA-256", points));
      return Array.from(hash, (byte) => byte.toString(16).padStart(2, "0")).join("");
    }, seed);

  const wanted = digest(await native("--radius 0.02 --seed 7"));
  assert.equal(await made(7), wanted);
  // The control: another seed gives another set.
  assert.notEqual(await made(8), wanted);
  nothingElse(wrong, []);
});
