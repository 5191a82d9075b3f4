// After the first visit the page needs no network; a new version is offered, not forced, and an incomplete one is
// refused.

import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import { once } from "node:events";
import { cp, readFile, rm, writeFile } from "node:fs/promises";
import { createServer } from "node:http";
import path from "node:path";
import { test } from "node:test";
import { DIST, IS_SLOW, folder, ready, serve, slowTest, state } from "./harness.mjs";
import { contextOf } from "./shared.mjs";

const LINK = "?engine=cpu#v=1&seed=6&radius=0.02";

/** Opens the page at a server, and waits until it has a service worker. */
async function visited(t, server) {
  const { context } = await contextOf(t, { server });
  const page = await context.newPage();
  await page.goto(`${server.address}/${LINK}`);
  await ready(page);
  await page.evaluate(async () => {
    const registration = await navigator.serviceWorker.ready;
    if (registration.active.state !== "activated") {
      await new Promise((resolve) => registration.active.addEventListener("statechange", resolve));
    }
  });
  return { context, page };
}

/** A copy of the page that may be changed, and its server. */
async function copied(t) {
  const copy = await folder(t);
  await cp(DIST, copy, { recursive: true });
  const server = await serve(copy);
  t.after(server.stop);
  return { copy, server };
}

/** Changes a file of a copy. @param {(text: string) => string} change */
async function edit(copy, name, change) {
  const file = path.join(copy, name);
  const text = await readFile(file, "utf8");
  await writeFile(file, change(text));
  // Their content is outdated.
  await Promise.all([".br", ".gz"].map((ending) => rm(file + ending, { force: true })));
}

/** Makes another version of a copy: its stylesheet has other bytes and another name. Returns what has changed. */
async function renew(copy, colour) {
  const worker = await readFile(path.join(copy, "sw.js"), "utf8");
  const [before] = worker.match(/style-[0-9a-f]{12}\.css/);
  const [, version] = worker.match(/VERSION = "([0-9a-f]{12})"/);
  const css = `${await readFile(path.join(copy, before), "utf8")}\n:root { --outside: ${colour}; }\n`;
  const hash = createHash("sha256").update(css).digest("hex").slice(0, 12);
  const name = `style-${hash}.css`;
  await writeFile(path.join(copy, name), css);
  await Promise.all(["", ".br", ".gz"].map((ending) => rm(path.join(copy, before + ending), { force: true })));
  await edit(copy, "index.html", (text) => text.replace(before, name));
  await edit(copy, "sw.js", (text) => text.replace(before, name).replace(version, hash));
  return { name, before, version: hash };
}

/** The versions whose files a page keeps. */
async function kept(page) {
  const names = await page.evaluate(() => caches.keys());
  return names.map((name) => name.match(/^tilescope-\/-([0-9a-f]{12})$/)[1]);
}

const colour = (page) => page.evaluate(() => getComputedStyle(document.documentElement).getPropertyValue("--outside"));

test("the page works without a network after the first visit", async (t) => {
  const server = await serve();
  const { context, page } = await visited(t, server);
  await page.close();
  await server.stop();
  const again = await context.newPage();
  // The browser's own cache would hide files that the page has not stored.
  const session = await context.newCDPSession(again);
  await session.send("Network.clearBrowserCache");
  await again.goto(`${server.address}/${LINK}`);
  await ready(again);
  const told = await state(again);
  assert.equal(told.verified, true);
  assert.equal(told.seed, 6);
  // The rest of the program comes from what the page has stored, too.
  await again.waitForFunction(() => performance.getEntriesByName("tilescope: all is there").length > 0);
});

test("a new version is offered, and comes with the user's consent", async (t) => {
  const { copy, server } = await copied(t);
  const { page } = await visited(t, server);
  assert.equal(await page.isHidden("#notice"), true);
  const [first] = await kept(page);
  const versions = [first];
  // Only the second change can remove the files of the first version, which slow runs test.
  for (const [number, wanted] of ["#102030", "#203010"].slice(0, IS_SLOW ? 2 : 1).entries()) {
    const { version } = await renew(copy, wanted);
    const old = await colour(page);
    await page.reload();
    await page.waitForSelector("#notice:not([hidden])");
    assert.match(await page.textContent("#notice"), /new version.*Escape, then Tab/is);
    assert.match(await page.textContent("#notice-said"), /new version/i);
    assert.equal(await colour(page), old, "it has come before it was accepted");
    // Accept the offer.
    await ready(page);
    await page.focus("#canvas");
    await page.keyboard.press("Escape");
    await page.keyboard.press("Tab");
    assert.equal(await page.evaluate(() => document.activeElement.id), "notice-reload");
    await Promise.all([page.waitForEvent("load"), page.keyboard.press("Enter")]);
    await ready(page);
    assert.equal((await state(page)).seed, 6, "the address was kept");
    assert.equal((await colour(page)).trim(), wanted);
    versions.push(version);
    // Another tab may still show the version before.
    assert.deepEqual(await kept(page), versions.slice(-2), `after change ${number}`);
  }
});

/** Serves the files of another server, and its page for all missing files, as some servers do. */
async function pageForAll(t, server) {
  const pass = async (url, response) => {
    let answer = await fetch(server.address + url);
    if (answer.status === 404) {
      answer = await fetch(`${server.address}/`);
    }
    response.setHeader("Content-Type", answer.headers.get("Content-Type"));
    response.end(Buffer.from(await answer.arrayBuffer()));
  };
  // The page may still ask when the other server has ended.
  const own = createServer(({ url }, response) => pass(url, response).catch(() => response.destroy()));
  own.listen(0, "127.0.0.1");
  await once(own, "listening");
  t.after(() => own.close());
  return { address: `http://127.0.0.1:${own.address().port}` };
}

/** Ways in which a new version may be broken. */
const BROKEN = {
  "lacks a file": (copy, { name }) => rm(path.join(copy, name)),
  "has the page of another one": (copy, { name, before }) => edit(copy, "index.html", (text) => text.replace(name, before)),
};

/** Makes a page look for a new version, and returns the version's final state. */
function update(page) {
  return page.evaluate(async () => {
    const registration = await navigator.serviceWorker.ready;
    const coming = new Promise((resolve) =>
      registration.addEventListener(
        "updatefound",
        () => {
          const { installing } = registration;
          installing.addEventListener("statechange", () => resolve(installing.state));
        },
        { once: true },
      ),
    );
    await registration.update();
    return coming;
  });
}

for (const [servedBy, given, ways] of [
  ["a server that reports missing files", (_, server) => server, Object.keys(BROKEN).slice(0, IS_SLOW ? undefined : 1)],
  ["a server that answers with its page for missing files", pageForAll, ["lacks a file"]],
]) {
  const declare = given === pageForAll ? slowTest : test;
  declare(`a new version that is broken is refused, and the one at hand stays, with ${servedBy}`, async (t) => {
    const { copy, server } = await copied(t);
    const { page } = await visited(t, await given(t, server));
    const before = await kept(page);
    for (const way of ways) {
      await cp(DIST, copy, { recursive: true });
      await BROKEN[way](copy, await renew(copy, "#102030"));
      assert.equal(await update(page), "redundant", way);
      assert.deepEqual(await kept(page), before, way);
    }
    await page.reload();
    await ready(page);
    assert.equal(await page.isHidden("#notice"), true);
  });
}
